// A depth image in the scene, or several of which a step shows one: surface, points, camera, and
// what the camera has not seen.

const COARSE_PIXELS = 12000, MOST_IMAGES_KEPT = 8;
const SURFACE_COLOR = '#8fa9c4', POINT_COLOR = '#5c7fa6', UNSEEN_COLOR = '#3a3a44', CAMERA_COLOR = '#22303c', REMOVED_COLOR = '#cc79a7';

// Makes the shapes of one image, each when it is first shown.
class ImageShapes {
  constructor(image) {
    this.image = image;
    this.depth = decodeDepth(image);
    this.made = {};
    this.count = 0;
    for (const d of this.depth) this.count += d > 0;
  }
  once(name, make) { return this.made[name] || (this.made[name] = make()); }
  // Returns a geometry of its own indices that shares the vertices of all pixels.
  over(indices) {
    const {positions, normals} = this.once('vertices', () => {
      const made = verticesOfDepth(this.depth, this.image);
      return {positions: new THREE.BufferAttribute(made.positions, 3), normals: new THREE.BufferAttribute(made.normals, 3)};
    });
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', positions);
    geometry.setAttribute('normal', normals);
    geometry.setIndex(new THREE.BufferAttribute(indices, 1));
    return geometry;
  }
  triangles() { return this.once('triangles', () => trianglesOfDepth(this.depth, this.image)); }
  surface() { return this.once('surface', () => this.over(this.triangles().surface)); }
  curtain() { return this.once('curtain', () => this.over(this.triangles().curtain)); }
  points() { return this.once('points', () => this.over(Uint32Array.from(this.depth.keys()).filter(k => this.depth[k] > 0))); }
  texture() { return this.once('texture', () => textureOfDepth(this.depth, this.image)); }
  coarse() {
    return this.once('coarse', () => {
      const small = thinned(this.depth, this.image, COARSE_PIXELS), {positions, normals} = verticesOfDepth(small.depth, small.image);
      return geometryOf(positions, normals, trianglesOfDepth(small.depth, small.image).surface);
    });
  }
  dispose() {
    for (const made of Object.values(this.made)) if (made.dispose) made.dispose();
  }
}

// Returns the camera's pyramid to a quarter of the median depth, with a mark at its upper edge.
function frustumOf(image) {
  const [fx, fy, cx, cy] = image.intrinsics, z = 0.25 * image.median, lines = [];
  const at = (u, v) => [(u - cx) / fx * z, (v - cy) / fy * z, z];
  const left = -0.5, top = -0.5, right = image.width - 0.5, bottom = image.height - 0.5;
  const corners = [at(left, top), at(right, top), at(right, bottom), at(left, bottom)];
  corners.forEach((corner, k) => lines.push(0, 0, 0, ...corner, ...corner, ...corners[(k + 1) % 4]));
  const middle = 0.5 * (left + right), peak = at(middle, top - 0.12 * image.height);
  lines.push(...at(middle - 0.12 * image.width, top), ...peak, ...peak, ...at(middle + 0.12 * image.width, top));
  return new Float32Array(lines);
}

// Returns the places, on the face of that pyramid, of pixels that show a known solid and were removed.
function removedOf(image) {
  const [fx, fy, cx, cy] = image.intrinsics, z = 0.25 * image.median, places = [];
  for (const k of image.removed ? decode(image.removed) : [])
    places.push((k % image.width - cx) / fx * z, (Math.floor(k / image.width) - cy) / fy * z, z);
  return new Float32Array(places);
}

// Draws the image that is shown at a step.
class ImageScene {
  constructor(layer) {
    this.images = layer.images;
    this.kept = new Map();
    this.isCoarse = false;
    this.toWorld = new THREE.Matrix4();
    const byNormal = layer.by === 'normal';
    this.surface = placed(new THREE.Mesh(undefined, surfaceMaterial({byNormal, color: SURFACE_COLOR})), 2);
    this.points = placed(new THREE.Points(undefined, surfaceMaterial({byNormal, color: POINT_COLOR})), 1);
    this.curtain = placed(new THREE.Mesh(undefined, solidMaterial(UNSEEN_COLOR, 0.35)), 3);
    this.frustum = lineSegments(new Float32Array(6), lineMaterial(CAMERA_COLOR, {width: 1.5}));
    this.removed = placed(new THREE.Points(geometryOf(new Float32Array(0)), dotMaterial(REMOVED_COLOR, 2, true)), 6);
    const corners = geometryOf(new Float32Array(12), null, new Uint32Array([0, 1, 2, 2, 1, 3]));
    this.sheet = placed(new THREE.Mesh(corners, sheetMaterial()), 4);
    this.unseen = new THREE.Group().add(this.curtain, this.sheet);
    this.moving = [this.surface, this.points, this.curtain, this.frustum, this.removed];
    for (const object of this.moving) object.matrixAutoUpdate = false;
  }

  shapesOf(image) {
    if (!this.kept.has(image)) {
      if (this.kept.size >= MOST_IMAGES_KEPT) {
        const [oldest, shapes] = this.kept.entries().next().value;
        shapes.dispose();
        this.kept.delete(oldest);
      }
      this.kept.set(image, new ImageShapes(image));
    }
    return this.kept.get(image);
  }

  show(number) {
    const image = this.images[number];
    if (image === this.image) return;
    this.image = image;
    this.shapes = this.shapesOf(image);
    this.toWorld = matrixOf(image.pose, 0);
    setSegments(this.frustum.geometry, frustumOf(image));
    this.removed.geometry.dispose();
    this.removed.geometry = geometryOf(removedOf(image));
    for (const object of this.moving) {
      object.matrix.copy(this.toWorld);
      object.matrixWorldNeedsUpdate = true;
    }
    const {toCamera, lens, size, range} = this.sheet.material.uniforms;
    toCamera.value.getInverse(this.toWorld);
    lens.value.set(...image.intrinsics);
    size.value.set(image.width, image.height);
    range.value.set(image.low, image.high);
  }

  // Opens a window before the tool and puts the sheet of what is unseen through its centre, along
  // the camera's sight and upwards.
  showTool(center, radius, up) {
    for (const object of [this.surface, this.points]) object.material.uniforms.hole.value.set(center.x, center.y, center.z, radius);
    const eye = new THREE.Vector3().setFromMatrixPosition(this.toWorld), sight = center.clone().sub(eye);
    const distance = sight.length() || 1, half = Math.max(2.2 * radius, 0.2 * distance);
    sight.divideScalar(distance);
    const across = up.clone().addScaledVector(sight, -up.dot(sight)).normalize();
    const near = Math.max(distance - 3 * radius, 0.05 * distance), far = distance + 3 * radius;
    const {position} = this.sheet.geometry.attributes;
    [[near, -half], [far, -half], [near, half], [far, half]].forEach(([z, y], k) => {
      const at = eye.clone().addScaledVector(sight, z).addScaledVector(across, y);
      position.setXYZ(k, at.x, at.y, at.z);
    });
    position.needsUpdate = true;
  }
}

function imageLayers(layer) {
  const shown = new ImageScene(layer), ofStep = layer.of_step ? decode(layer.of_step) : null;
  const of = layer.name.match(/( of .*)?$/)[0];
  const byNormal = layer.by === 'normal', look = color => byNormal ? {shape: 'normals'} : {color};
  const surface = {
    name: layer.name, type: 'surface', on: true, object: shown.surface, swatch: look(SURFACE_COLOR), shown, byNormal,
    opacity: shown.surface.material.uniforms.opacity,
    // A step that shows no image leaves the one before, which is not drawn.
    atStep(step) {
      const number = ofStep ? ofStep[Math.min(step, ofStep.length - 1)] : 0, isAbsent = number >= layer.images.length;
      if (!isAbsent || !shown.image) shown.show(isAbsent ? 0 : number);
      surface.count = points.count = shown.shapes.count;
      for (const own of all) own.isAbsent = isAbsent;
    },
    setCoarse(on) { shown.isCoarse = on; },
    showTool: (center, radius, up) => shown.showTool(center, radius, up),
    // Gives the objects that are switched on their shapes.
    fill() {
      if (surface.on) shown.surface.geometry = shown.isCoarse ? shown.shapes.coarse() : shown.shapes.surface();
      if (points.on) shown.points.geometry = shown.shapes.points();
      if (!unseen.on) return;
      shown.curtain.geometry = shown.shapes.curtain();
      shown.sheet.material.uniforms.depth.value = shown.shapes.texture();
    },
  };
  const points = {name: layer.name.replace('surface', 'points'), type: 'points', on: false, object: shown.points, swatch: look(POINT_COLOR)};
  const unseen = {
    name: 'not seen by the camera' + of, type: 'unseen', on: false, object: shown.unseen, swatch: {color: UNSEEN_COLOR},
    legend: [['hidden behind the surface', UNSEEN_COLOR], ['not measured', null, 'hatch'], ['out of view', '#c9b3df'], ['seen free', '#bfe1f2']],
  };
  const camera = {name: 'camera' + of, type: 'camera', on: true, object: shown.frustum, swatch: {color: CAMERA_COLOR, shape: 'line'}};
  const all = [surface, points, unseen, camera];
  if (!layer.images.some(image => image.removed)) return all;
  const removed = {name: 'removed from the image' + of, type: 'removed', on: true, object: shown.removed, swatch: {color: REMOVED_COLOR, shape: 'ball'}};
  removed.atStep = () => { removed.count = shown.removed.geometry.attributes.position.count; };
  all.push(removed);
  return all;
}
