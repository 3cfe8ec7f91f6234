#!/usr/bin/env bash
# JSCAD: the STL of a union of two spheres is not closed.
# Expected: the union of two spheres, written by JSCAD's STL serializer (which snaps and triangulates), is a closed surface.
# Seen: 166 edges have no partner of the same vertices, so that readers call the solid open. The union of two boxes is closed.
. "$(dirname "${BASH_SOURCE[0]}")/packages.sh"
npm_packages @jscad/modeling@2.13.0 @jscad/stl-serializer@2.1.23
run_js <<'JS'
import modeling from '@jscad/modeling';
import stl from '@jscad/stl-serializer';
import { readFileSync } from 'node:fs';
const { sphere, cuboid } = modeling.primitives;

function openEdges(geometry) {
  const text = stl.serialize({ binary: false }, geometry).join('');
  const corners = [...text.matchAll(/vertex (\S+) (\S+) (\S+)/g)].map((match) => match.slice(1, 4).map((c) => Number(c) + 0).join());
  const edges = new Map();
  for (let i = 0; i < corners.length; i += 3) for (let j = 0; j < 3; ++j) {
    const a = corners[i + j], b = corners[i + (j + 1) % 3], back = edges.get(`${b}|${a}`) ?? 0;
    if (a === b) continue;
    if (back > 0) edges.set(`${b}|${a}`, back - 1);
    else edges.set(`${a}|${b}`, (edges.get(`${a}|${b}`) ?? 0) + 1);
  }
  return [...edges.values()].reduce((sum, n) => sum + n, 0);
}
const union = (shape, shift) => modeling.booleans.union(shape, modeling.transforms.translate(shift, shape));
const ball = sphere({ radius: 1, segments: 32 });
const counts = [openEdges(ball), openEdges(union(cuboid({ size: [2, 2, 2] }), [1, 1, 1])), openEdges(union(ball, [1, 0.3, 0.2]))];
const version = JSON.parse(readFileSync('node_modules/@jscad/modeling/package.json')).version;
console.log(`@jscad/modeling ${version}: open edges of a sphere ${counts[0]}, of two boxes ${counts[1]}, of two spheres ${counts[2]}`);
process.exit(counts[0] === 0 && counts[1] === 0 && counts[2] > 0 ? 0 : 1);
JS
