#!/usr/bin/env bash
# three's exporters write a mirrored mesh inside out.
# Expected: a box with scale (-1, 1, 1), which three draws with its outside out, is exported with its outside out: volume +6.
# Seen: STL, PLY and OBJ have the mirrored vertices with the triangles' order kept, so that the signed volume is -6. Programs that
# tell inside from outside by the order take the solid for a cavity.
. "$(dirname "${BASH_SOURCE[0]}")/packages.sh"
npm_packages three@0.187.0
run_js <<'JS'
import * as THREE from 'three';
import { STLExporter } from 'three/examples/jsm/exporters/STLExporter.js';
import { PLYExporter } from 'three/examples/jsm/exporters/PLYExporter.js';
import { OBJExporter } from 'three/examples/jsm/exporters/OBJExporter.js';
import { STLLoader } from 'three/examples/jsm/loaders/STLLoader.js';
import { PLYLoader } from 'three/examples/jsm/loaders/PLYLoader.js';
import { OBJLoader } from 'three/examples/jsm/loaders/OBJLoader.js';

function volume(geometry) {
  const triangles = geometry.index ? geometry.toNonIndexed() : geometry;
  const p = triangles.attributes.position, corner = (i) => new THREE.Vector3().fromBufferAttribute(p, i);
  let sum = 0;
  for (let i = 0; i < p.count; i += 3) sum += corner(i).dot(corner(i + 1).cross(corner(i + 2))) / 6;
  return Number(sum.toFixed(5));
}
function volumes(scaleX) {
  const mesh = new THREE.Mesh(new THREE.BoxGeometry(1, 2, 3));
  mesh.scale.x = scaleX;
  mesh.updateMatrixWorld(true);
  return [volume(new STLLoader().parse(new STLExporter().parse(mesh))),
          volume(new PLYLoader().parse(new PLYExporter().parse(mesh))),
          volume(new OBJLoader().parse(new OBJExporter().parse(mesh)).children[0].geometry)];
}
const plain = volumes(1), mirrored = volumes(-1);
console.log(`three ${THREE.REVISION}: volumes in STL, PLY, OBJ: ${plain} as it is, ${mirrored} mirrored`);
process.exit(plain.every((v) => v === 6) && mirrored.every((v) => v === -6) ? 0 : 1);
JS
