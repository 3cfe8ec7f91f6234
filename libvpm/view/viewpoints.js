// Points of view: where a person wants to look from.

// Returns the axes of the camera whose image is shown, or of an upright world without one.
function frameOfView(stage, surface) {
  if (surface) {
    const {toWorld, image} = surface.shown, e = toWorld.elements;
    return {
      eye: new THREE.Vector3(e[12], e[13], e[14]), right: new THREE.Vector3(e[0], e[1], e[2]),
      down: new THREE.Vector3(e[4], e[5], e[6]), ahead: new THREE.Vector3(e[8], e[9], e[10]), image,
    };
  }
  const {up} = stage;
  const ahead = Math.abs(up.y) > 0.9 ? new THREE.Vector3(0, 0, -1) : new THREE.Vector3(0, 1, 0);
  return {right: new THREE.Vector3().crossVectors(ahead, up), down: up.clone().negate(), ahead};
}

// Returns the ball about the spheres that the surface cuts, in the world, or null.
function ballOfContact(layers, bodies) {
  const box = new THREE.Box3();
  for (const layer of layers.filter(l => l.states)) {
    const matrix = bodies[layer.body].group.matrix, wanted = layer.counts[1] ? 1 : 2;
    for (let k = 0; k < layer.count; ++k) {
      if (layer.states[k] !== wanted) continue;
      const at = new THREE.Vector3().fromArray(layer.centers, 3 * k).applyMatrix4(matrix);
      const r = new THREE.Vector3().setScalar(layer.radii[k]);
      box.expandByPoint(at.clone().add(r)).expandByPoint(at.sub(r));
    }
  }
  if (box.isEmpty()) return null;
  return {center: box.getCenter(new THREE.Vector3()), radius: 0.6 * box.getSize(new THREE.Vector3()).length()};
}

// Returns a ball about the first one that holds all of them.
function ballAround(balls) {
  const {center} = balls[0];
  return {center, radius: Math.max(...balls.map(ball => ball.center.distanceTo(center) + ball.radius))};
}

// Returns the ball that an image shows: about what lies at its median depth.
function ballOfImage({eye, ahead, image}) {
  const [fx, fy] = image.intrinsics, half = 0.5 * Math.hypot(image.width / fx, image.height / fy);
  return {center: eye.clone().addScaledVector(ahead, image.median), radius: 0.8 * image.median * half};
}

// Returns {name: function that looks from there}.
function makeViewpoints(stage, layers, allBodies, moves) {
  const bodies = allBodies.filter(body => body.isTool);
  const {camera, controls, extent} = stage, surface = layers.find(layer => layer.type === 'surface');
  const frame = () => frameOfView(stage, surface);
  const focus = () => bodies.length ? ballAround(bodies.map(body => body.ball())) : surface ? ballOfImage(frame()) : extent;

  // Looks along `direction` so that the ball fills the window.
  function look({center, radius}, direction, room) {
    camera.fov = 40;
    const narrow = Math.min(1, camera.aspect), angle = camera.fov * narrow * Math.PI / 360;
    camera.up.copy(stage.up);
    controls.target.copy(center);
    camera.position.copy(center).addScaledVector(direction.normalize(), -room * radius / Math.sin(angle));
    controls.update();
    stage.draw();
  }
  function between(from, right, down, ahead) {
    return new THREE.Vector3().addScaledVector(from.right, right).addScaledVector(from.down, down).addScaledVector(from.ahead, ahead);
  }
  // Returns a ball about the bodies that reaches to the middle of what is scanned, so that both show.
  function wide() {
    const near = focus();
    if (!bodies.length || !moves) return near;
    const scene = surface ? ballOfImage(frame()) : extent;
    const center = near.center.clone().lerp(scene.center, 0.5);
    const apart = center.distanceTo(near.center);
    return {center, radius: Math.max(2 * near.radius, apart + near.radius, apart + 0.5 * scene.radius)};
  }
  const viewpoints = {
    overview() { look(wide(), between(frame(), -0.85, 0.5, 1), 1); },
    camera() {
      if (!surface) return viewpoints.overview();
      const {eye, ahead, image} = frame(), {width, height, intrinsics} = image;
      const distance = Math.max(focus().center.clone().sub(eye).dot(ahead), 0.2 * image.median);
      const shown = Math.min(1, camera.aspect * height / width);
      camera.fov = 2 * Math.atan(0.5 * height / intrinsics[1] / shown) * 180 / Math.PI;
      camera.up.copy(stage.up);
      camera.position.copy(eye);
      controls.target.copy(eye).addScaledVector(ahead, distance);
      controls.update();
      stage.draw();
    },
    side() { look(focus(), between(frame(), -1, 0, 0.05), bodies.length && moves ? 1.6 : 1); },
    contact() { look(ballOfContact(layers, bodies) || focus(), between(frame(), -0.9, 0.3, 0.35), 1.1); },
    all() { look(extent, between(frame(), -0.6, 0.4, 1), 1.1); },
  };
  return viewpoints;
}
