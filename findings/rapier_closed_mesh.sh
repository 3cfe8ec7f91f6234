#!/usr/bin/env bash
# Rapier: a closed triangle mesh with ORIENTED normals is a shell to contacts, though it tells points inside.
# Expected: a ball of radius 0.1 whose centre is 0.02, 0.1 and 0.2 behind a face of a unit cube is 0.12, 0.2 and 0.3 deep, for the
# cube's mesh as for the cuboid (the flag ORIENTED makes the mesh solid: containsPoint() says that the centre is inside).
# Seen: the mesh pushes it inwards from where the centre is behind the face (0.08 deep), and lets it go at 0.1.
. "$(dirname "${BASH_SOURCE[0]}")/packages.sh"
npm_packages @dimforge/rapier3d-compat@0.21.0
run_js <<'JS'
import RAPIER from '@dimforge/rapier3d-compat';
await RAPIER.init();
const corners = new Float32Array([-1,-1,-1, 1,-1,-1, 1,1,-1, -1,1,-1, -1,-1,1, 1,-1,1, 1,1,1, -1,1,1].map((c) => c / 2));
const faces = new Uint32Array([0,2,1, 0,3,2, 4,5,6, 4,6,7, 0,1,5, 0,5,4, 1,2,6, 1,6,5, 2,3,7, 2,7,6, 3,0,4, 3,4,7]);
const mesh = new RAPIER.TriMesh(corners, faces, RAPIER.TriMeshFlags.ORIENTED), cuboid = new RAPIER.Cuboid(0.5, 0.5, 0.5);
const ball = new RAPIER.Ball(0.1), turn = { x: 0, y: 0, z: 0, w: 1 }, origin = { x: 0, y: 0, z: 0 };
const rows = [0.02, 0.1, 0.2].map((behind) => {
  const center = { x: 0.5 - behind, y: 0, z: 0.01 };
  const ask = (shape) => shape.contactShape(origin, turn, ball, center, turn, 1);
  return { truth: 0.1 + behind, cuboid: -ask(cuboid).distance, mesh: -ask(mesh).distance, normal: ask(mesh).normal1.x,
           inside: mesh.containsPoint(origin, turn, center) };
});
console.log(`rapier ${RAPIER.version()}: ` + rows.map((r) => `truth ${r.truth.toFixed(2)}, cuboid ${r.cuboid.toFixed(2)}, mesh ` +
            `${r.mesh.toFixed(2)} along ${r.normal.toFixed(0)} x, inside ${r.inside}`).join('; '));
const near = (a, b) => Math.abs(a - b) < 1e-4;
process.exit(rows.every((r) => near(r.cuboid, r.truth) && r.inside && near(r.normal, -1)) && near(rows[0].mesh, 0.08) &&
             near(rows[1].mesh, 0) && near(rows[2].mesh, -0.1) ? 0 : 1);
JS
