// Shows the Voronoi cell of a sphere that is clicked, as the samples that the measure takes of it.

function makeCellPicker(stage, layers, packedLevels) {
  const levels = packedLevels.map(level => ({begin: decode(level.begin), positions: decodePositions(level.positions)}));
  const key = document.getElementById('key'), keyBefore = [...key.childNodes];
  let shown = null;

  const pickable = () => layers.find(l => l.cellsOf !== undefined && l.object.visible);

  function hide() {
    if (!shown) return;
    stage.scene.remove(shown.object);
    shown.object.geometry.dispose();
    shown = null;
    key.replaceChildren(...keyBefore);
  }
  // Shows the cell of a sphere of the level that is visible; of none if `sphere` is negative.
  function show(sphere) {
    hide();
    const layer = pickable();
    if (layer && sphere >= 0) {
      const level = levels[layer.cellsOf];
      const positions = level.positions.slice(3 * level.begin[sphere], 3 * level.begin[sphere + 1]);
      const object = placed(new THREE.Points(geometryOf(positions), dotMaterial('#c80000', 4, false)), 9);
      shown = {object, sphere, samples: positions.length / 3};
      stage.scene.add(object);
      key.replaceChildren(
        element('div', {textContent: `Sphere ${sphere}, radius ${valueText(layer.radii[sphere], 'm')}`}),
        element('div', {className: 'row'}, swatch({color: '#c80000', shape: 'ball'}),
          element('span', {textContent: `${shown.samples} samples of its Voronoi cell`})));
    }
    stage.draw();
  }
  function pick(event) {
    const layer = pickable();
    if (!layer) return;
    const box = stage.canvas.getBoundingClientRect(), caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2(2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height), stage.camera);
    const ball = new THREE.Sphere(), place = new THREE.Vector3();
    let nearest = Infinity, found = -1;
    for (let k = 0; k < layer.count; ++k) {
      ball.center.fromArray(layer.centers, 3 * k);
      ball.radius = layer.radii[k];
      if (!caster.ray.intersectSphere(ball, place)) continue;
      const distance = place.distanceTo(caster.ray.origin);
      if (distance < nearest) nearest = distance, found = k;
    }
    show(found);
  }
  let pressed = null;
  stage.canvas.addEventListener('pointerdown', event => { pressed = event; });
  stage.canvas.addEventListener('pointerup', event => {
    if (pressed && Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) < 4) pick(event);
  });
  return {show, hide, report: () => shown && {sphere: shown.sphere, samples: shown.samples}};
}
