// Draws the scene into the canvas whenever something has changed. Where frames take long, layers are
// coarser and pixels larger for as long as something moves. Where software draws, frames count as
// long from the first: the time they take is spent after the page has been told that they are drawn.

const SLOW = 60;      // ms from asking for a frame to drawing it, of a browser that is behind
const SLOW_FRAMES = 2;  // in a row, before all becomes coarser

function drawsBySoftware(context) {
  const info = context.getExtension('WEBGL_debug_renderer_info');
  const name = info ? context.getParameter(info.UNMASKED_RENDERER_WEBGL) : '';
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

function webgl(canvas) {
  const context = canvas.getContext('webgl2', {antialias: false, alpha: true});
  if (context) return context;
  const fault = document.getElementById('fault');
  fault.hidden = false;
  fault.textContent = 'This browser draws no WebGL 2: open the file in a newer one, or switch hardware acceleration on.';
  throw new Error('no WebGL 2');
}

class Stage {
  constructor(canvas, doc) {
    this.canvas = canvas;
    this.context = webgl(canvas);
    this.bySoftware = drawsBySoftware(this.context);
    this.renderer = new THREE.WebGLRenderer({canvas, context: this.context, alpha: true});
    this.scene = new THREE.Scene();
    this.up = new THREE.Vector3(...doc.up);
    this.camera = new THREE.PerspectiveCamera(45, 1, 0.01, 100);
    this.camera.up.copy(this.up);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.enableKeys = false;
    this.controls.screenSpacePanning = true;
    this.controls.maxPolarAngle = Math.PI;
    // The box of all that is shown, in the world; far strays of a cloud do not count.
    this.extent = {center: new THREE.Vector3(...doc.center), radius: doc.radius};
    this.firstPicture = 0;  // ms since the page was asked for
    this.quality = 1;       // pixels drawn per pixel shown each way, at rest
    this.isMoving = this.isPlaying = this.isWanted = false;
    this.isCoarse = true;  // for the first picture
    this.slowFrames = 0;
    this.onCoarse = () => {};
    this.controls.addEventListener('change', () => this.draw());
    this.controls.addEventListener('start', () => { this.isMoving = true; });
    this.controls.addEventListener('end', () => { this.isMoving = false; this.rest(); });
    window.addEventListener('resize', () => this.resize());
  }

  // Draws once, soon.
  draw() {
    if (this.isWanted) return;
    this.isWanted = true;
    const asked = performance.now();
    requestAnimationFrame(() => {
      this.isWanted = false;
      if (this.isMoving || this.isPlaying) {
        this.slowFrames = performance.now() - asked > SLOW ? this.slowFrames + 1 : 0;
        if (this.bySoftware || this.slowFrames >= SLOW_FRAMES) this.setCoarse(true);
      }
      this.render();
      if (this.firstPicture) return;
      this.firstPicture = performance.now();
      this.setCoarse(false);
      this.draw();
    });
  }

  render() {
    const {camera, extent} = this, size = Math.max(extent.radius, camera.position.distanceTo(extent.center));
    camera.near = Math.max(0.02 * camera.position.distanceTo(this.controls.target), 1e-4 * size);
    camera.far = 4 * (size + extent.radius);
    camera.updateProjectionMatrix();
    this.renderer.render(this.scene, camera);
  }

  // Draws as well as can be: nothing moves any more.
  rest() {
    this.slowFrames = 0;
    this.setCoarse(false);
    this.draw();
  }

  setCoarse(on) {
    if (on === this.isCoarse) return;
    this.isCoarse = on;
    this.fitPixels();
    this.onCoarse(on);
  }

  // A graphics card smooths edges by more pixels than are shown; a processor has enough to do.
  pixelRatio() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    if (this.isCoarse) return this.bySoftware ? 0.5 * ratio : ratio;
    return this.quality * (this.bySoftware ? ratio : Math.max(ratio, 2));
  }

  fitPixels() {
    const {clientWidth, clientHeight} = this.canvas.parentElement, ratio = this.pixelRatio();
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(clientWidth, clientHeight, false);
    PIXELS.value.set(clientWidth, clientHeight, ratio);
  }

  resize() {
    const {clientWidth, clientHeight} = this.canvas.parentElement;
    this.fitPixels();
    this.camera.aspect = clientWidth / Math.max(clientHeight, 1);
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  setQuality(quality) {
    this.quality = quality;
    this.resize();
  }

  // Returns the milliseconds of a frame while the scene turns, drawn and read back.
  bench(frames) {
    const {camera, controls, context} = this, pixel = new Uint8Array(4), begin = performance.now();
    for (let k = 0; k < frames; ++k) {
      camera.position.sub(controls.target).applyAxisAngle(this.up, 0.05).add(controls.target);
      camera.lookAt(controls.target);
      this.render();
      context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, pixel);
    }
    return (performance.now() - begin) / frames;
  }

  // Returns what the last frame drew.
  load() {
    const {calls, triangles, points} = this.renderer.info.render;
    return {calls, triangles, points};
  }
}
