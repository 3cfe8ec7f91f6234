// Each layer of the document becomes objects of the scene:
// {name, type, count, on, object, swatch, atStep(step), setCoarse(on)}, all after `swatch` where needed.

const VIRIDIS = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
function viridis(t) {
  const at = Math.min(Math.max(t, 0), 1) * (VIRIDIS.length - 1), k = Math.min(Math.floor(at), VIRIDIS.length - 2);
  return VIRIDIS[k].map((c, i) => c + (at - k) * (VIRIDIS[k + 1][i] - c));
}

function matrixOf(pose, at) {
  return new THREE.Matrix4().compose(
    new THREE.Vector3(pose[at], pose[at + 1], pose[at + 2]),
    new THREE.Quaternion(pose[at + 3], pose[at + 4], pose[at + 5], pose[at + 6]).normalize(),
    new THREE.Vector3(1, 1, 1));
}

function geometryOf(positions, normals, indices) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  if (normals) geometry.setAttribute('normal', new THREE.BufferAttribute(normals, 3));
  if (indices) geometry.setIndex(new THREE.BufferAttribute(indices, 1));
  return geometry;
}

function placed(object, order) {
  object.frustumCulled = false;
  object.renderOrder = order || 0;
  return object;
}

// A body moves as a whole: its group has the pose of the step.
class Body {
  constructor({name, radius, center, is_tool: isTool, poses}) {
    this.name = name;
    this.isTool = isTool;
    this.radius = radius;
    this.center = new THREE.Vector3(...center);
    this.poses = decode(poses);
    this.step = 0;
    this.group = new THREE.Group();
    this.group.matrixAutoUpdate = false;
  }
  poseAt(step) { return matrixOf(this.poses, 7 * Math.min(step, this.poses.length / 7 - 1)); }
  centerAt(step) { return this.center.clone().applyMatrix4(this.poseAt(step)); }
  atStep(step) {
    this.step = step;
    this.group.matrix.copy(this.poseAt(step));
    this.group.matrixWorldNeedsUpdate = true;
  }
  // Returns the ball about the body where it is.
  ball() { return {center: this.centerAt(this.step), radius: this.radius}; }
}

function pointLayers(layer) {
  const positions = decodePositions(layer.positions), byNormal = layer.by === 'normal';
  const normals = layer.normals ? decodeNormals(layer.normals) : new Float32Array(positions.length);
  const object = placed(new THREE.Points(geometryOf(positions, normals), surfaceMaterial({byNormal, color: POINT_COLOR})), 1);
  return [{name: layer.name, type: 'points', count: positions.length / 3, on: true, object, swatch: byNormal ? {shape: 'normals'} : {color: POINT_COLOR}, byNormal}];
}

function meshLayers(layer) {
  const indices = decode(layer.indices), material = solidMaterial(layer.color, layer.opacity);
  const object = placed(new THREE.Mesh(geometryOf(decodePositions(layer.positions), null, indices), material), layer.opacity < 1 ? 5 : 0);
  return [{
    name: layer.name, type: 'mesh', body: layer.body, count: indices.length / 3, on: layer.on, object,
    swatch: {color: layer.color}, opacity: material.uniforms.opacity, step: layer.step,
  }];
}

const STATES = ['outside', 'boundary', 'inside'], COARSE_SPHERES = 2000;

// Returns the geometry of `count` spheres: a square for each, which the shader turns to the eye.
function sphereGeometry(centers, radii) {
  const count = radii.length, spheres = new Float32Array(4 * count), geometry = new THREE.InstancedBufferGeometry();
  for (let k = 0; k < count; ++k) spheres.set([centers[3 * k], centers[3 * k + 1], centers[3 * k + 2], radii[k]], 4 * k);
  geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array([-1, -1, 0, 1, -1, 0, -1, 1, 0, 1, 1, 0]), 3));
  geometry.setIndex([0, 1, 2, 2, 1, 3]);
  geometry.setAttribute('sphere', new THREE.InstancedBufferAttribute(spheres, 4));
  geometry.setAttribute('tint', new THREE.InstancedBufferAttribute(new Uint8Array(3 * count), 3, true));
  geometry.setAttribute('state', new THREE.InstancedBufferAttribute(new Uint8Array(count), 1));
  return geometry;
}

// Lets the colours of spheres tell their states at the step.
function colorByState(own, bits, colors) {
  const {tint, state} = own.object.geometry.attributes, rgb = STATES.map(name => rgbOf(colors[name]));
  own.states = state.array;
  own.counts = [0, 0, 0, 0];  // the last counts spheres beyond the level that the step used
  own.legend = STATES.map((name, k) => [name, colors[name], 'ball', k]);
  own.shownStates = own.object.material.uniforms.shownStates.value;
  own.swatch = {color: colors.boundary, shape: 'ball'};
  own.atStep = step => {
    statesOfStep(bits, own.count, step, own.states);
    own.counts.fill(0);
    for (let k = 0; k < own.count; ++k) {
      ++own.counts[own.states[k]];
      tint.array.set(rgb[own.states[k] % 3], 3 * k);
    }
    tint.needsUpdate = state.needsUpdate = true;
  };
}

// Returns the smallest and largest radius of all spheres that are coloured by it: levels share a
// scale, so that a sphere keeps its colour.
function rangeOfRadii(layers) {
  let low = Infinity, high = 0;
  for (const layer of layers.filter(l => l.type === 'spheres' && !l.states))
    for (const r of decode(layer.radii)) low = Math.min(low, r), high = Math.max(high, r);
  return {low, high};
}

// Lets the colours of spheres tell their radii, on a logarithmic scale.
function colorByRadius(own, {low, high}) {
  const {radii} = own, {array} = own.object.geometry.attributes.tint;
  radii.forEach((r, k) => array.set(viridis(high > low ? Math.log(r / low) / Math.log(high / low) : 1), 3 * k));
  own.key = {name: 'radius', unit: 'm', low, high};
  own.swatch = {shape: 'viridis ball'};
}

function sphereLayers(layer, colors, range) {
  const centers = decodePositions(layer.centers), radii = decode(layer.radii), count = radii.length;
  const geometry = sphereGeometry(centers, radii), object = placed(new THREE.Mesh(geometry, sphereMaterial()), 0);
  const own = {name: layer.name, type: 'spheres', body: layer.body, count, on: layer.on, object, centers, radii, step: layer.step, cellsOf: layer.cells};
  if (layer.states) colorByState(own, decode(layer.states), colors);
  else colorByRadius(own, range);
  let most = count, prefix = count;  // spheres are sorted by radius, the largest first
  const restrict = () => { geometry.maxInstancedCount = Math.min(most, prefix); };
  own.setCoarse = on => { most = on ? COARSE_SPHERES : count; restrict(); };
  if (layer.prefix) own.atStep = step => { own.count = prefix = Math.min(step + 1, count); restrict(); };
  return [own];
}

function lineLayers(layer) {
  const positions = decodePositions(layer.positions), group = new THREE.Group();
  const lines = lineSegments(positions, lineMaterial(layer.color, {width: layer.marks ? 3 : 1.5, above: layer.above}));
  group.add(lines);
  if (layer.marks) group.add(placed(new THREE.Points(geometryOf(positions), dotMaterial(layer.color, 7, !layer.above)), 6));
  return [{name: layer.name, type: 'lines', body: layer.body, count: layer.count, on: layer.on, object: group, swatch: {color: layer.color, shape: 'line'}, step: layer.step}];
}

// Points that are shown before their step.
function dustLayers(layer) {
  const geometry = geometryOf(decodePositions(layer.positions)), until = Float32Array.from(decode(layer.until));
  geometry.setAttribute('until', new THREE.BufferAttribute(until, 1));
  const material = dotMaterial(layer.color, 3, true, 'until > step');
  const own = {name: layer.name, type: 'dust', unit: layer.unit, on: layer.on, object: placed(new THREE.Points(geometry, material), 1), swatch: {color: layer.color, shape: 'ball'}};
  own.atStep = step => {
    material.uniforms.step.value = step;
    own.count = until.reduce((n, k) => n + (k > step), 0);
  };
  return [own];
}

function pathLayers(layer, bodies) {
  const body = bodies[layer.body], count = body.poses.length / 7, positions = new Float32Array(3 * count), segments = [];
  for (let k = 0; k < count; ++k) body.centerAt(k).toArray(positions, 3 * k);
  for (let k = 0; layer.joined && k + 1 < count; ++k) segments.push(...positions.subarray(3 * k, 3 * k + 6));
  const group = new THREE.Group().add(
    lineSegments(new Float32Array(segments), lineMaterial(layer.color, {width: 1.5, above: true, opacity: 0.6})),
    placed(new THREE.Points(geometryOf(positions), dotMaterial(layer.color, 4, false)), 6));
  return [{name: layer.name, type: 'path', count, unit: 'poses', on: layer.on, object: group,
    swatch: {color: layer.color, shape: layer.joined ? 'line' : 'ball'}}];
}

// Returns the parts of an arrow of length 1 along y: shaft, one or two heads, and a ring about it.
function arrowParts(thick, ring, color) {
  const material = solidMaterial(color, 1);
  material.depthTest = false;
  const mesh = geometry => placed(new THREE.Mesh(geometry, material), 8);
  const shaft = mesh(new THREE.CylinderBufferGeometry(thick, thick, 1, 12).translate(0, 0.5, 0));
  const head = () => mesh(new THREE.ConeBufferGeometry(3 * thick, 8 * thick, 16).translate(0, -4 * thick, 0));
  const heads = ring ? [head(), head()] : [head()];
  const rings = ring ? [mesh(new THREE.TorusBufferGeometry(7 * thick, thick, 8, 32, 1.6 * Math.PI).rotateX(Math.PI / 2))] : [];
  return {shaft, heads, rings};
}

// An arrow at the body's centre of mass, in world axes; the longest of all steps is 1.4 body radii. That of
// a torque has two heads and a ring about it.
function arrowLayers(layer, bodies, columns) {
  const body = bodies[layer.body], {values} = columns[layer.column], thick = 0.025 * body.radius, group = new THREE.Group();
  const {shaft, heads, rings} = arrowParts(thick, layer.ring, layer.color), turned = new THREE.Group().add(shaft, ...heads, ...rings);
  group.add(turned);
  const at = step => new THREE.Vector3().fromArray(values, 3 * step);
  let largest = 0;
  for (let k = 0; k < values.length / 3; ++k) largest = Math.max(largest, at(k).length());
  return [{
    name: layer.name, type: 'arrow', on: layer.on, object: group, swatch: {color: layer.color, shape: 'line'},
    atStep(step) {
      const along = at(step), size = along.length();
      turned.visible = size > 0;
      if (!(size > 0)) return;
      const length = Math.max(1.4 * body.radius * size / largest, 8 * thick);
      turned.position.copy(body.centerAt(step));
      turned.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.divideScalar(size));
      shaft.scale.y = Math.max(length - 6 * thick, 1e-9);
      heads.forEach((head, k) => head.position.set(0, length - 5 * thick * k, 0));
    },
  }];
}

const MAKERS = {
  image: imageLayers, points: pointLayers, mesh: meshLayers, lines: lineLayers, dust: dustLayers,
  spheres: (layer, context) => sphereLayers(layer, context.colors, context.radii),
  path: (layer, context) => pathLayers(layer, context.bodies),
  arrow: (layer, context) => arrowLayers(layer, context.bodies, context.columns),
};
function makeLayers(doc, bodies, columns) {
  const context = {colors: doc.colors, bodies, columns, radii: rangeOfRadii(doc.layers)};
  return doc.layers.flatMap(layer => MAKERS[layer.type](layer, context));
}
