// Reads files of spheres with three.js and prints what it found: node three_reads.js THREE_FOLDER FILE...
const fs = require("fs"), vm = require("vm"), path = require("path");
const [folder, ...files] = process.argv.slice(2);
global.self = global;
global.THREE = require(path.join(folder, "build/three.js"));
for (const loader of ["GLTFLoader", "PLYLoader"])
  vm.runInThisContext(fs.readFileSync(path.join(folder, "examples/js/loaders", loader + ".js"), "utf8"));

function placed(node) {
  const geometry = node.geometry.clone();
  (geometry.applyMatrix4 || geometry.applyMatrix).call(geometry, node.matrixWorld);  // the name since r113, and before
  return geometry;
}

function facts(geometries) {
  let vertices = 0, triangles = 0;
  const box = new THREE.Box3();
  for (const geometry of geometries) {
    vertices += geometry.attributes.position.count;
    triangles += geometry.index ? geometry.index.count / 3 : 0;
    geometry.computeBoundingBox();
    box.union(geometry.boundingBox);
  }
  return {vertices, triangles, low: box.min.toArray(), high: box.max.toArray()};
}

for (const file of files) {
  const bytes = fs.readFileSync(file), buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
  const print = (geometries) => console.log(path.basename(file), JSON.stringify(facts(geometries)));
  if (file.endsWith(".ply")) {
    print([new THREE.PLYLoader().parse(buffer)]);
  } else {
    new THREE.GLTFLoader().parse(buffer, "", (gltf) => {
      const geometries = [];
      gltf.scene.updateMatrixWorld();
      gltf.scene.traverse((node) => { if (node.isMesh) geometries.push(placed(node)); });
      print(geometries);
    }, (fault) => { console.error(file, fault); process.exit(1); });
  }
}
