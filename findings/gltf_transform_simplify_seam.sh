#!/usr/bin/env bash
# glTF Transform's simplify() opens a closed surface between two materials.
# Expected: a closed surface of two primitives (one for each material), whose borders have equal vertices, stays closed.
# Seen: each primitive is simplified for itself, and its border with it, so that triangles along the seam lose their partners.
# `lockBorder: true` keeps it closed.
. "$(dirname "${BASH_SOURCE[0]}")/packages.sh"
npm_packages @gltf-transform/core@4.5.1 @gltf-transform/functions@4.5.1 meshoptimizer@1.3.0
run_js <<'JS'
import { Document } from '@gltf-transform/core';
import { simplify, weld } from '@gltf-transform/functions';
import { MeshoptSimplifier } from 'meshoptimizer';
import { readFileSync } from 'node:fs';

// An octahedron's faces, each of n x n triangles, on the unit sphere; vertices with equal coordinates have equal bits.
function sphere(n) {
  const halves = [[], []];
  for (const x of [1, -1]) for (const y of [1, -1]) for (const z of [1, -1]) {
    const at = (i, j) => {
      const p = [x * i, y * j, z * (n - i - j)], length = Math.hypot(...p);
      return p.map((c) => Math.fround(c / length) + 0);
    };
    const add = (a, b, c) => halves[z > 0 ? 0 : 1].push(x * y * z > 0 ? [a, b, c] : [a, c, b]);
    for (let i = 0; i < n; ++i) for (let j = 0; i + j < n; ++j) {
      add(at(i, j), at(i + 1, j), at(i, j + 1));
      if (i + j + 1 < n) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return halves;
}
function documentOf(halves) {
  const document = new Document(), buffer = document.createBuffer(), mesh = document.createMesh();
  document.createScene().addChild(document.createNode().setMesh(mesh));
  for (const [k, half] of halves.entries()) {
    const positions = document.createAccessor().setType('VEC3').setArray(new Float32Array(half.flat(2))).setBuffer(buffer);
    mesh.addPrimitive(document.createPrimitive().setAttribute('POSITION', positions)
                        .setMaterial(document.createMaterial(`half ${k}`)));
  }
  return document;
}
// Returns the numbers of triangles and of edges without a partner.
function counts(document) {
  const edges = new Map();
  let triangles = 0;
  for (const primitive of document.getRoot().listMeshes()[0].listPrimitives()) {
    const position = primitive.getAttribute('POSITION'), indices = primitive.getIndices();
    const corner = (i) => position.getElement(indices ? indices.getScalar(i) : i, []).map((c) => c + 0).join();
    const n = indices ? indices.getCount() : position.getCount();
    triangles += n / 3;
    for (let i = 0; i < n; i += 3) for (let j = 0; j < 3; ++j) {
      const a = corner(i + j), b = corner(i + (j + 1) % 3), back = edges.get(`${b}|${a}`) ?? 0;
      if (back > 0) edges.set(`${b}|${a}`, back - 1);
      else edges.set(`${a}|${b}`, (edges.get(`${a}|${b}`) ?? 0) + 1);
    }
  }
  return { triangles, open: [...edges.values()].reduce((sum, n) => sum + n, 0) };
}
await MeshoptSimplifier.ready;
const results = [];
for (const options of [null, {}, { lockBorder: true }]) {
  const document = documentOf(sphere(24));
  if (options) await document.transform(weld(), simplify({ simplifier: MeshoptSimplifier, ratio: 0.25, error: 0.01, ...options }));
  results.push(counts(document));
}
const version = JSON.parse(readFileSync('node_modules/@gltf-transform/functions/package.json')).version;
const [before, after, locked] = results;
console.log(`@gltf-transform/functions ${version}: ${before.triangles} triangles with ${before.open} open edges become ` +
            `${after.triangles} with ${after.open} (with lockBorder ${locked.triangles} with ${locked.open})`);
process.exit(before.open === 0 && after.open > 0 && locked.open === 0 ? 0 : 1);
JS
