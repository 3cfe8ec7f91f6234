// How things look. Colours of the legend are those of the scene: shading only darkens them.

// The window's width and height in CSS pixels, and the pixels drawn per CSS pixel; for all shaders.
const PIXELS = {value: new THREE.Vector3(1, 1, 1)};

function rgbOf(color) { return new THREE.Color(color).toArray().map(c => Math.round(255 * c)); }

const LIGHT = `
float lit(vec3 n, vec3 toEye) {
  float key = max(dot(n, normalize(vec3(0.35, 0.6, 0.75))), 0.0);
  return 0.45 + 0.25 * abs(dot(n, toEye)) + 0.36 * key;
}`;

// Points, or triangles between them. A window opens in what is between the eye and the tool (`hole`:
// its centre and radius), where few pixels are left.
function surfaceMaterial(options) {
  return new THREE.ShaderMaterial({
    transparent: true, side: THREE.DoubleSide,
    uniforms: {
      color: {value: new THREE.Color(options.color || '#8fa9c4')}, opacity: {value: 1},
      hole: {value: new THREE.Vector4(0, 0, 0, 0)}, pixels: PIXELS,
      byNormal: {value: options.byNormal ? 1 : 0},
    },
    vertexShader: `
      uniform vec3 pixels; uniform vec4 hole;
      varying vec3 vNormal, vModel, vView, vHole;
      void main() {
        vec4 view = modelViewMatrix * vec4(position, 1.0);
        vNormal = normalMatrix * normal; vModel = normal; vView = view.xyz;
        vHole = (viewMatrix * vec4(hole.xyz, 1.0)).xyz;
        gl_Position = projectionMatrix * view;
        gl_PointSize = 2.0 * pixels.z;
      }`,
    fragmentShader: LIGHT + `
      uniform vec3 color; uniform float opacity, byNormal; uniform vec4 hole;
      varying vec3 vNormal, vModel, vView, vHole;
      void main() {
        vec3 toEye = normalize(-vView), n = vNormal;
        bool known = dot(n, n) > 0.1;
        n = known ? normalize(n) : toEye;
        if (dot(n, toEye) < 0.0) n = -n;
        vec3 base = byNormal > 0.5 ? (known ? 0.5 + 0.5 * normalize(vModel) * vec3(1.0, -1.0, -1.0) : vec3(0.25)) : color;
        if (hole.w > 0.0) {
          float far = length(vHole), near = dot(vView, vHole) / far;
          float off = length(vView * (far / max(near, 1e-9)) - vHole) / hole.w;
          float left = near > 0.0 && near < far + hole.w ? mix(0.1, 1.0, smoothstep(0.95, 1.2, off)) : 1.0;
          vec2 cell = mod(floor(gl_FragCoord.xy), 4.0);
          float order = mod(cell.x * 5.0 + cell.y * 7.0 + mod(cell.x + cell.y, 2.0) * 8.0, 16.0);
          if (order + 0.5 > 16.0 * left) discard;
        }
        gl_FragColor = vec4(base * (byNormal > 0.5 ? 0.75 + 0.25 * lit(n, toEye) : lit(n, toEye)), opacity);
      }`,
  });
}

function solidMaterial(color, opacity) {
  return new THREE.ShaderMaterial({
    transparent: true, side: THREE.DoubleSide, depthWrite: opacity >= 1,
    uniforms: {color: {value: new THREE.Color(color)}, opacity: {value: opacity}},
    vertexShader: `
      varying vec3 vView;
      void main() { vec4 view = modelViewMatrix * vec4(position, 1.0); vView = view.xyz; gl_Position = projectionMatrix * view; }`,
    fragmentShader: LIGHT + `
      uniform vec3 color; uniform float opacity; varying vec3 vView;
      void main() {
        vec3 toEye = normalize(-vView), n = normalize(cross(dFdx(vView), dFdy(vView)));
        if (dot(n, toEye) < 0.0) n = -n;
        float rim = 1.0 - abs(dot(n, toEye));
        gl_FragColor = vec4(color * lit(n, toEye), opacity >= 1.0 ? 1.0 : mix(0.6 * opacity, min(1.0, 2.4 * opacity), rim * rim));
      }`,
  });
}

// A square per sphere, turned to the eye, on which the ray meets the sphere.
function sphereMaterial() {
  return new THREE.ShaderMaterial({
    uniforms: {shownStates: {value: new THREE.Vector3(1, 1, 1)}},
    vertexShader: `
      attribute vec4 sphere; attribute vec3 tint; attribute float state;
      uniform vec3 shownStates;
      varying vec3 vAt, vCenter, vTint; varying float vRadius;
      void main() {
        vec3 c = (modelViewMatrix * vec4(sphere.xyz, 1.0)).xyz;
        float shown = state < 0.5 ? shownStates.x : state < 1.5 ? shownStates.y : state < 2.5 ? shownStates.z : 0.0;
        float r = sphere.w * shown, d2 = max(dot(c, c), 1e-20);
        vec3 forward = c / sqrt(d2), right = normalize(cross(forward, abs(forward.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
        float grown = r * r >= 0.98 * d2 ? 7.0 * r : r / sqrt(1.0 - r * r / d2);
        vAt = c + grown * (position.x * right + position.y * cross(right, forward));
        vCenter = c; vRadius = r; vTint = tint;
        gl_Position = r > 0.0 ? projectionMatrix * vec4(vAt, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
      }`,
    fragmentShader: LIGHT + `
      uniform mat4 projectionMatrix;
      varying vec3 vAt, vCenter, vTint; varying float vRadius;
      void main() {
        vec3 ray = normalize(vAt);
        float along = dot(ray, vCenter);
        vec3 across = vCenter - along * ray;
        float half2 = vRadius * vRadius - dot(across, across);
        if (half2 < 0.0) discard;
        vec3 at = (along - sqrt(half2)) * ray, n = (at - vCenter) / vRadius;
        vec4 clip = projectionMatrix * vec4(at, 1.0);
        gl_FragDepthEXT = 0.5 + 0.5 * clip.z / clip.w;
        float rim = smoothstep(0.0, 0.22, sqrt(half2) / vRadius);
        gl_FragColor = vec4(vTint * lit(n, -ray) * mix(0.55, 1.0, rim), 1.0);
      }`,
  });
}

// Draws what the camera saw on a sheet: free before the surface, hidden behind it, not measured.
function sheetMaterial() {
  return new THREE.ShaderMaterial({
    transparent: true, depthWrite: false, side: THREE.DoubleSide,
    uniforms: {depth: {value: null}, toCamera: {value: new THREE.Matrix4()}, lens: {value: new THREE.Vector4()},
      size: {value: new THREE.Vector2()}, range: {value: new THREE.Vector2()}},
    vertexShader: `
      uniform mat4 toCamera; varying vec3 vCamera;
      void main() {
        vec4 world = modelMatrix * vec4(position, 1.0);
        vCamera = (toCamera * world).xyz;
        gl_Position = projectionMatrix * viewMatrix * world;
      }`,
    fragmentShader: `
      uniform sampler2D depth; uniform vec4 lens; uniform vec2 size, range;
      varying vec3 vCamera;
      void main() {
        vec2 at = vCamera.xy / vCamera.z * lens.xy + lens.zw + 0.5;
        if (vCamera.z <= 0.0 || at.x < 0.0 || at.y < 0.0 || at.x >= size.x || at.y >= size.y) {
          gl_FragColor = vec4(0.55, 0.3, 0.75, 0.3);
          return;
        }
        vec4 bytes = texture2D(depth, at / size) * 255.0;
        float steps = bytes.r + 256.0 * bytes.g;
        float seen = range.x + (steps - 1.0) * (range.y - range.x) / 65534.0;
        if (steps < 0.5) {
          if (mod(gl_FragCoord.x + gl_FragCoord.y, 9.0) > 3.0) discard;
          gl_FragColor = vec4(0.25, 0.25, 0.28, 0.55);
        } else if (vCamera.z > seen) gl_FragColor = vec4(0.16, 0.16, 0.2, 0.5);
        else gl_FragColor = vec4(0.34, 0.71, 0.91, 0.14);
      }`,
  });
}

// Round dots of `size` CSS pixels. With `condition`, a GLSL expression of the attribute `until` and the uniform
// `step`, only those that meet it.
function dotMaterial(color, size, hides, condition) {
  return new THREE.ShaderMaterial({
    depthTest: hides,
    uniforms: {color: {value: new THREE.Color(color)}, size: {value: size}, step: {value: 0}, pixels: PIXELS},
    vertexShader: `
      ${condition ? 'attribute float until;' : ''} uniform float step, size; uniform vec3 pixels;
      void main() {
        gl_PointSize = size * pixels.z;
        gl_Position = ${condition || 'true'} ? projectionMatrix * modelViewMatrix * vec4(position, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
      }`,
    fragmentShader: `
      uniform vec3 color;
      void main() {
        vec2 at = 2.0 * gl_PointCoord - 1.0;
        if (dot(at, at) > 1.0) discard;
        gl_FragColor = vec4(color, 1.0);
      }`,
  });
}

// Lines of `width` CSS pixels, as squares between their ends: lines of WebGL are one pixel wide.
function lineMaterial(color, {width, opacity = 1, above = false}) {
  return new THREE.ShaderMaterial({
    transparent: true, depthTest: !above, side: THREE.DoubleSide,
    uniforms: {color: {value: new THREE.Color(color)}, opacity: {value: opacity}, width: {value: width}, pixels: PIXELS},
    vertexShader: `
      attribute vec3 from, to; uniform vec3 pixels; uniform float width;
      void main() {
        vec4 a = projectionMatrix * modelViewMatrix * vec4(from, 1.0), b = projectionMatrix * modelViewMatrix * vec4(to, 1.0);
        float least = 1e-4 * max(max(a.w, b.w), 1e-9);  // ends behind the eye move before it
        if (a.w < least) a = mix(a, b, (least - a.w) / max(b.w - a.w, 1e-9));
        if (b.w < least) b = mix(b, a, (least - b.w) / max(a.w - b.w, 1e-9));
        vec2 along = (b.xy / b.w - a.xy / a.w) * pixels.xy;
        along = dot(along, along) > 0.0 ? normalize(along) : vec2(1.0, 0.0);
        vec4 end = position.x < 0.5 ? a : b;
        end.xy += position.y * width * vec2(-along.y, along.x) / pixels.xy * end.w;
        gl_Position = max(a.w, b.w) > 0.0 ? end : vec4(2.0, 2.0, 2.0, 1.0);
      }`,
    fragmentShader: 'uniform vec3 color; uniform float opacity; void main() { gl_FragColor = vec4(color, opacity); }',
  });
}

// Gives a geometry lines between each two of the places.
function setSegments(geometry, places) {
  const ends = new THREE.InstancedInterleavedBuffer(places, 6);
  geometry.setAttribute('from', new THREE.InterleavedBufferAttribute(ends, 3, 0));
  geometry.setAttribute('to', new THREE.InterleavedBufferAttribute(ends, 3, 3));
  geometry.maxInstancedCount = places.length / 6;
}
function lineSegments(places, material) {
  const geometry = new THREE.InstancedBufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array([0, -1, 0, 1, -1, 0, 0, 1, 0, 1, 1, 0]), 3));
  geometry.setIndex([0, 1, 2, 2, 1, 3]);
  setSegments(geometry, places);
  return placed(new THREE.Mesh(geometry, material), 6);
}
