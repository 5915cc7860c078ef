"use strict";
// The viewer of sampled scenes: plain JavaScript over WebGL 2, without any library and without the network.
// Coordinates are Scenic's: X east, Y north, Z up, in metres. Matrices are column-major arrays of sixteen numbers.

(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const byId = (id) => document.getElementById(id);
  const canvas = byId("view");
  const gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
  if (!gl) {
    byId("trouble").hidden = false;
    byId("trouble").textContent = "This page needs WebGL 2, which this browser does not offer.";
    return;
  }

  // ---- Small vector and matrix arithmetic -----------------------------------------------------------------------

  const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
  const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => times(a, 1 / Math.hypot(...a));

  function product(a, b) {
    const c = new Float32Array(16);
    for (let j = 0; j < 4; j++) {
      for (let i = 0; i < 4; i++) {
        let sum = 0;
        for (let k = 0; k < 4; k++) sum += a[k * 4 + i] * b[j * 4 + k];
        c[j * 4 + i] = sum;
      }
    }
    return c;
  }

  function lookAt(eye, ahead, up) {
    const right = unit(cross(ahead, up));
    const top = cross(right, ahead);
    return new Float32Array([
      right[0], top[0], -ahead[0], 0, right[1], top[1], -ahead[1], 0, right[2], top[2], -ahead[2], 0,
      -dot(right, eye), -dot(top, eye), dot(ahead, eye), 1,
    ]);
  }

  function perspective(fov, aspect, near, far) {
    const f = 1 / Math.tan(fov / 2);
    return new Float32Array([
      f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0,
    ]);
  }

  function orthographic(half, near, far, aspect = 1) {
    return new Float32Array([
      1 / (half * aspect), 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, 2 / (near - far), 0, 0, 0, (far + near) / (near - far), 1,
    ]);
  }

  function rotation([x, y, z, w]) {
    return [
      [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
      [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
      [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
    ]; // columns
  }

  // ---- Shaders --------------------------------------------------------------------------------------------------

  const SOLID_VERTEX = `#version 300 es
    layout(location = 0) in vec3 place;
    layout(location = 1) in vec3 normal;
    layout(location = 2) in vec4 paint;
    uniform mat4 camera, sunCamera, model;
    uniform vec3 size;
    out vec3 worldNormal, world, sunPlace;
    out vec4 own;
    void main() {
      vec4 point = model * vec4(place, 1.0);
      own = paint;
      world = point.xyz;
      // The model's columns are long as the size is; a normal needs the inverse.
      worldNormal = mat3(model) * (normal / (size * size));
      vec4 lit = sunCamera * point;
      sunPlace = lit.xyz * 0.5 + 0.5;
      gl_Position = camera * point;
    }`;
  const LIGHT = `
    uniform highp sampler2DShadow shadows;
    uniform vec3 sun;
    uniform float texel, ambientScale;
    float sunlight(vec3 place, vec3 normal) {
      float facing = dot(normal, sun);
      if (facing <= 0.0) return 0.0;
      float bias = texel * (0.6 + 1.4 * sqrt(max(0.0, 1.0 - facing * facing)) / max(facing, 0.15));
      float total = 0.0;
      for (int i = -2; i <= 2; i++)
        for (int j = -2; j <= 2; j++)
          total += texture(shadows, vec3(place.xy + vec2(i, j) * texel * 0.8, place.z - bias));
      bool inside = all(lessThan(abs(place - 0.5), vec3(0.5)));
      return facing * (inside ? total / 25.0 : 1.0);
    }
    vec3 encode(vec3 light) {
      light = clamp(light, 0.0, 1.0);
      return mix(light * 12.92, 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, light));
    }
    vec3 illuminate(vec3 color, vec3 normal, vec3 place) {
      float up = normal.z * 0.5 + 0.5;
      vec3 ambient = mix(vec3(0.30, 0.285, 0.27), vec3(0.56, 0.60, 0.64), up) * ambientScale;
      return color * (ambient + sunlight(place, normal) * vec3(0.92, 0.88, 0.83));
    }`;
  const SOLID_FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 worldNormal, world, sunPlace;
    in vec4 own;
    uniform vec4 color;
    uniform vec3 eye;
    uniform float glow;
    out vec4 shown;
    ${LIGHT}
    void main() {
      vec3 toEye = normalize(eye - world);
      vec3 normal = normalize(worldNormal);
      if (dot(normal, toEye) < 0.0) normal = -normal;
      vec3 light = illuminate(mix(color.rgb, own.rgb, own.a), normal, sunPlace);
      float rim = pow(1.0 - max(dot(normal, toEye), 0.0), 2.0);
      vec3 mark = glow > 0.75 ? vec3(0.15, 0.45, 1.0) : vec3(0.9, 0.75, 0.3);
      light = mix(light, mark, glow * (0.25 + 0.6 * rim));
      shown = vec4(encode(light), color.a);
    }`;
  const GROUND_VERTEX = `#version 300 es
    layout(location = 0) in vec3 place;
    uniform mat4 camera, sunCamera;
    uniform vec3 middle;
    uniform float extent;
    out vec3 world, sunPlace;
    void main() {
      world = middle + vec3(place.xy * 2.0 * extent, 0.0);
      sunPlace = (sunCamera * vec4(world, 1.0)).xyz * 0.5 + 0.5;
      gl_Position = camera * vec4(world, 1.0);
    }`;
  const GROUND_FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 world, sunPlace;
    uniform vec3 ground, line, middle;
    uniform float extent, spacing, lines;
    out vec4 shown;
    ${LIGHT}
    float grid(float step) {
      vec2 at = world.xy / step;
      vec2 foot = max(fwidth(at), vec2(1e-5));
      vec2 cover = clamp(1.1 - abs(at - round(at)) / foot, 0.0, 1.0) * clamp(1.5 - 5.0 * foot, 0.0, 1.0);
      return max(cover.x, cover.y);
    }
    void main() {
      float mark = lines * max(0.35 * grid(spacing), 0.7 * grid(spacing * 5.0));
      vec3 color = illuminate(mix(ground, line, mark), vec3(0.0, 0.0, 1.0), sunPlace);
      float away = length(world.xy - middle.xy) / extent;
      float fade = 1.0 - smoothstep(0.35, 1.0, away);
      shown = vec4(encode(color), fade);
    }`;
  const PLAIN_VERTEX = `#version 300 es
    layout(location = 0) in vec3 place;
    uniform mat4 camera, model;
    void main() { gl_Position = camera * model * vec4(place, 1.0); }`;
  const PLAIN_FRAGMENT = `#version 300 es
    precision highp float;
    uniform vec4 color;
    out vec4 shown;
    void main() { shown = color; }`;

  function program(vertex, fragment) {
    const made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
    const places = {};
    for (let i = 0; i < gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); i++) {
      const { name } = gl.getActiveUniform(made, i);
      places[name] = gl.getUniformLocation(made, name);
    }
    return { made, places };
  }

  const solid = program(SOLID_VERTEX, SOLID_FRAGMENT);
  const groundProgram = program(GROUND_VERTEX, GROUND_FRAGMENT);
  const plain = program(PLAIN_VERTEX, PLAIN_FRAGMENT);

  // ---- Meshes ---------------------------------------------------------------------------------------------------

  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));

  function mesh(points, normals, indices, paints) {
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const store = (target, content) => {
      gl.bindBuffer(target, gl.createBuffer());
      gl.bufferData(target, content, gl.STATIC_DRAW);
    };
    store(gl.ARRAY_BUFFER, points);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    if (normals) {
      store(gl.ARRAY_BUFFER, normals);
      gl.enableVertexAttribArray(1);
      gl.vertexAttribPointer(1, 3, gl.SHORT, true, 8, 0);
    }
    if (paints) {
      store(gl.ARRAY_BUFFER, paints);
      gl.enableVertexAttribArray(2);
      gl.vertexAttribPointer(2, 4, gl.UNSIGNED_BYTE, true, 0, 0);
    }
    store(gl.ELEMENT_ARRAY_BUFFER, indices);
    gl.bindVertexArray(null);
    return { array, count: indices.length };
  }

  const meshes = data.meshes.map((item) => {
    const points = new Float32Array(bytes(item.points).buffer);
    const indices = new Uint32Array(bytes(item.indices).buffer);
    const paints = item.paints && bytes(item.paints);
    return { ...mesh(points, new Int16Array(bytes(item.normals).buffer), indices, paints), points, indices };
  });
  // Meshes without colours of their own have the object's.
  gl.vertexAttrib4f(2, 0, 0, 0, 0);
  const square = mesh(
    new Float32Array([-0.5, -0.5, 0, 0.5, -0.5, 0, 0.5, 0.5, 0, -0.5, 0.5, 0]), null, new Uint32Array([0, 1, 2, 0, 2, 3]));
  const cubeEdges = mesh(
    new Float32Array([0, 1, 2, 3, 4, 5, 6, 7].flatMap((i) => [(i & 1) - 0.5, ((i >> 1) & 1) - 0.5, (i >> 2) - 0.5])),
    null, new Uint32Array([0, 1, 2, 3, 4, 5, 6, 7, 0, 2, 1, 3, 4, 6, 5, 7, 0, 4, 1, 5, 2, 6, 3, 7]));

  function draw(item, mode = gl.TRIANGLES) {
    gl.bindVertexArray(item.array);
    gl.drawElements(mode, item.count, gl.UNSIGNED_INT, 0);
  }

  /** Line segments between following points of each line, for `draw(item, gl.LINES)`; nothing if there are none. */
  function segments(lines) {
    const points = [];
    for (const line of lines) {
      for (let i = 1; i < line.length; i++) points.push(...line[i - 1], ...line[i]);
    }
    if (!points.length) return null;
    return mesh(new Float32Array(points), null, Uint32Array.from({ length: points.length / 3 }, (_, i) => i));
  }

  // ---- Scenes ---------------------------------------------------------------------------------------------------

  const linear = (value) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
  const lightColors = data.lights.map((color) => [...color.map(linear), 1]);

  /** Puts an object where its position and quaternion say. */
  function settle(thing) {
    const sides = rotation(thing.quaternion).map((column, axis) => times(column, thing.size[axis]));
    thing.model = new Float32Array([...sides[0], 0, ...sides[1], 0, ...sides[2], 0, ...thing.position, 1]);
    thing.corners = [];
    for (let i = 0; i < 8; i++) {
      const signs = [(i & 1) - 0.5, ((i >> 1) & 1) - 0.5, (i >> 2) - 0.5];
      let corner = thing.position;
      signs.forEach((sign, axis) => { corner = add(corner, times(sides[axis], sign)); });
      thing.corners.push(corner);
    }
  }

  /** Puts all objects of a simulation where they are after so many steps; those that do not exist yet are absent. */
  function settleAll(scene, step) {
    const { poses } = scene.course;
    scene.objects.forEach((thing, index) => {
      const start = (step * scene.objects.length + index) * 7;
      thing.absent = Number.isNaN(poses[start]);
      if (thing.absent) return;
      thing.position = Array.from(poses.subarray(start, start + 3));
      thing.quaternion = Array.from(poses.subarray(start + 3, start + 7));
      thing.euler = eulerAngles(thing.quaternion);
      if (thing.seen) {
        const axes = rotation(thing.quaternion);
        const place = (point) => point.reduce((sum, part, axis) => add(sum, times(axes[axis], part)), thing.position);
        thing.view = thing.seen.map((line) => line.map(place));
      }
      settle(thing);
    });
  }

  /** Yaw, pitch and roll: rotations about Z, the new X and the new Y. */
  function eulerAngles(quaternion) {
    const [right, front, top] = rotation(quaternion);
    return [Math.atan2(-front[0], front[1]), Math.asin(Math.max(-1, Math.min(1, front[2]))), Math.atan2(-right[2], top[2])];
  }

  for (const scene of data.scenes) {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    const extend = (thing) => thing.corners.forEach((corner) => corner.forEach((value, axis) => {
      low[axis] = Math.min(low[axis], value);
      high[axis] = Math.max(high[axis], value);
    }));
    for (const thing of scene.objects) {
      thing.light = [...thing.color.slice(0, 3).map(linear), thing.color[3]];
      settle(thing);
      if (!scene.course) extend(thing);
    }
    if (scene.course) {
      // The space that is shown is that of the whole simulation; a hundred moments tell it well enough.
      scene.course.poses = new Float32Array(bytes(scene.course.poses).buffer);
      for (const thing of scene.objects) {
        // What it has in view, in its own frame, moves with it.
        const axes = rotation(thing.quaternion);
        thing.seen = thing.view?.map((line) => line.map((point) => axes.map((axis) => dot(axis, sub(point, thing.position)))));
      }
      const stride = Math.max(1, Math.floor(scene.course.steps / 100));
      for (let step = 0; step <= scene.course.steps; step += stride) {
        settleAll(scene, step);
        for (const thing of scene.objects) if (!thing.absent) extend(thing);
      }
      settleAll(scene, 0);
    }
    for (const lamp of scene.lamps ?? []) settle(lamp);
    // Numbers of colours, state by state.
    if (scene.lamps) scene.lampColors = bytes(scene.lampColors);
    if (!scene.objects.length) { low.fill(-0.5); high.fill(0.5); }
    if (scene.least) {
      // So much of the ground is shown at least.
      for (const axis of [0, 1]) {
        const missing = Math.max(0, scene.least - (high[axis] - low[axis])) / 2;
        low[axis] -= missing;
        high[axis] += missing;
      }
    }
    scene.middle = times(add(low, high), 0.5);
    scene.radius = Math.max(Math.hypot(...sub(high, low)) / 2, 1e-3);
    scene.low = low;
    scene.high = high;
    scene.border = scene.workspace === null ? [] : data.outlines[scene.workspace];
    scene.width = Math.max(5 * scene.radius,
      ...scene.border.flat().map((point) => 1.5 * Math.hypot(point[0] - scene.middle[0], point[1] - scene.middle[1])));
  }
  // Each region keeps its colour from scene to scene.
  const regionNames = [...new Set(data.scenes.flatMap((scene) => Object.keys(scene.regions)))];
  const HUES = [205, 330, 45, 165, 275, 15, 120, 240, 75, 300];
  const regionColor = (name, dark) => {
    const place = regionNames.indexOf(name);
    return hsl(HUES[place % HUES.length], 0.75, (dark ? 0.65 : 0.42) + 0.06 * (Math.floor(place / HUES.length) % 3));
  };
  function hsl(hue, saturation, lightness) {
    const a = saturation * Math.min(lightness, 1 - lightness);
    const part = (n) => {
      const k = (n + hue / 30) % 12;
      return lightness - a * Math.max(-1, Math.min(k - 3, 9 - k, 1));
    };
    return [part(0), part(8), part(4)];
  }
  // One ground and one grid for all scenes, so that stepping through them does not make them jump.
  const reach = Math.max(...data.scenes.map((scene) => scene.radius));
  const groundWidth = Math.max(...data.scenes.map((scene) => scene.width));
  const lowest = Math.min(...data.scenes.map((scene) => scene.low[2]));
  // Parts of the ground with colours: those that are flat lie on it, others where they are, and the ground below them.
  const grounds = (data.grounds ?? []).map((piece) => ({
    ...piece, light: [...piece.color.slice(0, 3).map(linear), 1],
    low: piece.flat ? Infinity : meshes[piece.mesh].points.reduce((low, value, i) => (i % 3 === 2 ? Math.min(low, value) : low), Infinity),
  }));
  const groundHeight = Math.min(lowest < 0 || lowest > 8 * reach ? lowest : 0, ...grounds.map((piece) => piece.low - 0.1));
  for (const piece of grounds) {
    piece.model = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, piece.flat ? groundHeight : 0, 1]);
  }
  const power = 10 ** Math.floor(Math.log10(reach / 6));
  const spacing = [1, 2, 5, 10].map((step) => step * power)
    .reduce((best, step) => (Math.abs(Math.log((step * 6) / reach)) < Math.abs(Math.log((best * 6) / reach)) ? step : best));

  // ---- What is shown --------------------------------------------------------------------------------------------

  const state = {
    scene: 0, step: 0, near: -1, chosen: -1, following: false, behind: false, running: 0, playing: 0, dark: false, flat: false, measuring: false, measured: [],
    layers: { ground: true, grid: true, workspace: true, regions: true, views: false, headings: false, labels: false, trails: true },
  };
  /** Regions not shown. Those of a whole road network would only hide each other, and the map shows them better. */
  const hiddenRegions = new Set(data.grounds ? regionNames : regionNames.slice(12));
  /** Objects not shown, by their place in the list and their name, so that they stay hidden from scene to scene. */
  const hidden = new Set();
  const keyOf = (thing, index) => `${index} ${thing.label}`;
  const isHidden = (index) => current().objects[index].absent || hidden.has(keyOf(current().objects[index], index));
  const view = { target: [0, 0, 0], distance: 10, azimuth: (-35 * Math.PI) / 180, elevation: (33 * Math.PI) / 180 };
  const FOV = (38 * Math.PI) / 180;
  const current = () => data.scenes[state.scene];

  const ahead = () => [
    Math.sin(view.azimuth) * Math.cos(view.elevation),
    Math.cos(view.azimuth) * Math.cos(view.elevation),
    -Math.sin(view.elevation),
  ];
  const rightward = () => [Math.cos(view.azimuth), -Math.sin(view.azimuth), 0];
  const upward = () => cross(rightward(), ahead());
  const eye = () => sub(view.target, times(ahead(), view.distance));

  /** The nearest view in the present direction that shows all of the points. */
  function frame(points) {
    const aspect = canvas.clientWidth / Math.max(canvas.clientHeight, 1);
    const t = Math.tan(FOV / 2) / 1.08;
    const axes = [rightward(), upward(), ahead()];
    const local = points.map((point) => axes.map((axis) => dot(axis, point)));
    const bounds = [[t * aspect, 0], [t, 1]].map(([tangent, axis]) => {
      const low = Math.max(...local.map((p) => p[axis] - tangent * p[2]));
      const high = Math.min(...local.map((p) => p[axis] + tangent * p[2]));
      return { low, high, tangent, depth: (high - low) / (2 * tangent) };
    });
    const depth = Math.min(bounds[0].depth, bounds[1].depth);
    const side = bounds.map(({ low, high, tangent }) => (low + tangent * depth + high - tangent * depth) / 2);
    const place = add(add(times(axes[0], side[0]), times(axes[1], side[1])), times(axes[2], depth));
    const middle = times(points.reduce(add, [0, 0, 0]), 1 / points.length);
    view.distance = Math.max(dot(sub(middle, place), axes[2]), reach * 1e-3);
    view.target = add(place, times(axes[2], view.distance));
    changed();
  }

  /** Corners of the objects, of a simulation those of the box in which it takes place. */
  const cornersOf = (scene) => (scene.course || scene.least
    ? [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [0, 1, 2].map((axis) => ((i >> axis) & 1 ? scene.high : scene.low)[axis]))
    : scene.objects.flatMap((thing) => thing.corners));

  /** Shows the workspace and what is in view, as far as they are shown, and the objects of all scenes. */
  function wholeScene() {
    const views = current().objects.flatMap((thing) => (thing.view ?? []).flat());
    const points = data.scenes.flatMap(cornersOf)
      .concat(state.layers.workspace ? data.scenes[0].border.flat() : [], state.layers.views ? views : []);
    frame(points.length ? points : [[-1, -1, -1], [1, 1, 1]]);
  }

  /** Shows the objects of this scene that are not hidden, from where the camera looks now. */
  function refit() {
    const points = current().objects.flatMap((thing, index) => (isHidden(index) ? [] : thing.corners));
    if (points.length) frame(points);
  }

  // ---- Drawing --------------------------------------------------------------------------------------------------

  const SHADOW = 2048;
  const shadowMap = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, shadowMap);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOW, SHADOW);
  for (const [name, value] of [
    [gl.TEXTURE_MIN_FILTER, gl.LINEAR], [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
    [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
    [gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE],
  ]) gl.texParameteri(gl.TEXTURE_2D, name, value);
  const shadowTarget = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, shadowTarget);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, shadowMap, 0);
  gl.drawBuffers([gl.NONE]);

  // Objects under the pointer are found by drawing their numbers as colours.
  const pickColor = gl.createRenderbuffer();
  const pickDepth = gl.createRenderbuffer();
  const pickTarget = gl.createFramebuffer();
  let pickSize = [0, 0];

  const sun = unit([-0.55, -0.33, 0.77]);
  let sunCamera = null;
  let shadowsOf = -1;
  let pickOf = "";
  let pending = false;

  function changed() {
    if (!pending) {
      pending = true;
      requestAnimationFrame(render);
    }
  }

  function drawShadows() {
    const scene = current();
    const half = scene.radius * 1.05;
    sunCamera = product(
      orthographic(half, 0, 4 * half), lookAt(add(scene.middle, times(sun, 2 * half)), times(sun, -1), [0, 1, 0]));
    gl.bindFramebuffer(gl.FRAMEBUFFER, shadowTarget);
    gl.viewport(0, 0, SHADOW, SHADOW);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.useProgram(plain.made);
    gl.uniformMatrix4fv(plain.places.camera, false, sunCamera);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1.5, 2);
    scene.objects.forEach((thing, index) => {
      if (isHidden(index)) return;
      gl.uniformMatrix4fv(plain.places.model, false, thing.model);
      draw(meshes[thing.mesh]);
    });
    gl.disable(gl.POLYGON_OFFSET_FILL);
    shadowsOf = state.scene;
  }

  function viewCamera() {
    const scene = current();
    const middle = dot(sub(scene.middle, eye()), ahead());
    const span = scene.radius + 1.2 * groundWidth + reach;
    const far = Math.max(middle + span, view.distance * 2);
    const aspect = canvas.width / canvas.height;
    if (state.flat) {
      const half = view.distance * Math.tan(FOV / 2);
      return product(orthographic(half, middle - span, far + span, aspect), lookAt(eye(), ahead(), upward()));
    }
    // The ground below the camera may be nearer than every object: it must not be cut.
    const height = Math.abs(eye()[2] - groundHeight);
    const nearest = Math.min(middle - scene.radius * 1.2, view.distance * 0.9, Math.max(height * 0.5, reach * 1e-3));
    const near = Math.max(nearest, far / 50000);
    return product(perspective(FOV, aspect, near, far), lookAt(eye(), ahead(), upward()));
  }

  function lightUniforms(places) {
    gl.uniform3fv(places.sun, sun);
    gl.uniform1f(places.texel, 1 / SHADOW);
    gl.uniform1f(places.ambientScale, state.dark ? 0.75 : 1);
    gl.uniform1i(places.shadows, 0);
    gl.uniformMatrix4fv(places.sunCamera, false, sunCamera);
  }

  function drawObject(thing, glow) {
    gl.uniformMatrix4fv(solid.places.model, false, thing.model);
    gl.uniform3fv(solid.places.size, thing.size);
    gl.uniform4fv(solid.places.color, thing.light);
    gl.uniform1f(solid.places.glow, glow);
    draw(meshes[thing.mesh]);
  }

  /** Traffic lights and signs, in the colours of the present state. */
  function drawLamps(scene) {
    (scene.lamps ?? []).forEach((lamp, index) => {
      const color = lightColors[scene.lampColors[state.step * scene.lamps.length + index]];
      drawObject({ ...lamp, light: color }, 0);
    });
  }

  function render() {
    pending = false;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    gl.enable(gl.DEPTH_TEST);
    if (shadowsOf !== state.scene) drawShadows();
    const scene = current();
    const camera = viewCamera();
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, width, height);
    const backdrop = state.dark ? [0.09, 0.106, 0.133] : [0.91, 0.925, 0.95];
    gl.clearColor(...backdrop, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, shadowMap);

    gl.useProgram(solid.made);
    gl.uniformMatrix4fv(solid.places.camera, false, camera);
    gl.uniform3fv(solid.places.eye, eye());
    lightUniforms(solid.places);
    const glow = (index) => (index === state.chosen ? 1 : index === state.near ? 0.5 : 0);
    const shown = scene.objects.map((thing, index) => ({ thing, index })).filter(({ index }) => !isHidden(index));
    for (const { thing, index } of shown) if (thing.light[3] >= 1) drawObject(thing, glow(index));
    if (state.layers.ground) drawLamps(scene);
    if (state.layers.ground && eye()[2] > groundHeight) {
      gl.enable(gl.POLYGON_OFFSET_FILL);
      for (const number of scene.ground ?? []) {
        // From far away, a few centimetres do not tell what is on top.
        gl.polygonOffset(-grounds[number].layer / 2, -4 * grounds[number].layer);
        drawObject({ ...grounds[number], size: [1, 1, 1] }, 0);
      }
      gl.disable(gl.POLYGON_OFFSET_FILL);
    }

    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.useProgram(groundProgram.made);
    gl.uniformMatrix4fv(groundProgram.places.camera, false, camera);
    lightUniforms(groundProgram.places);
    gl.uniform3f(groundProgram.places.middle, scene.middle[0], scene.middle[1], groundHeight);
    gl.uniform1f(groundProgram.places.extent, groundWidth);
    gl.uniform1f(groundProgram.places.spacing, spacing);
    gl.uniform1f(groundProgram.places.lines, state.layers.grid ? 1 : 0);
    gl.uniform3fv(groundProgram.places.ground, state.dark ? [0.035, 0.04, 0.05] : [0.6, 0.62, 0.65]);
    gl.uniform3fv(groundProgram.places.line, state.dark ? [0.13, 0.15, 0.18] : [0.26, 0.29, 0.33]);
    // A little behind where it is, so that it does not hide lines that lie on it.
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 2);
    if (eye()[2] > groundHeight) draw(square); // from below, the ground would only hide things
    gl.disable(gl.POLYGON_OFFSET_FILL);

    // Transparent objects, the farthest first; their inner sides are not seen.
    gl.useProgram(solid.made);
    gl.depthMask(false);
    gl.enable(gl.CULL_FACE);
    shown.map(({ thing, index }) => ({ thing, index, depth: dot(sub(thing.position, eye()), ahead()) }))
      .filter(({ thing }) => thing.light[3] < 1)
      .sort((a, b) => b.depth - a.depth)
      .forEach(({ thing, index }) => drawObject(thing, glow(index)));
    gl.disable(gl.CULL_FACE);
    gl.depthMask(true);

    gl.useProgram(plain.made);
    gl.uniformMatrix4fv(plain.places.camera, false, camera);
    drawLines(scene);
    const ego = scene.objects.findIndex((thing) => thing.ego);
    if (ego >= 0 && !isHidden(ego)) {
      gl.uniformMatrix4fv(plain.places.model, false, scene.objects[ego].model);
      gl.uniform4f(plain.places.color, 0.86, 0.58, 0.05, 0.9);
      draw(cubeEdges, gl.LINES);
    }
    if (state.chosen >= 0 && !isHidden(state.chosen)) {
      gl.uniformMatrix4fv(plain.places.model, false, scene.objects[state.chosen].model);
      gl.uniform4fv(plain.places.color, state.dark ? [0.45, 0.66, 1, 0.9] : [0.12, 0.4, 0.8, 0.8]);
      draw(cubeEdges, gl.LINES);
    }
    gl.disable(gl.BLEND);
    gl.bindVertexArray(null);
    drawCompass();
    drawLabels(camera);
  }

  const IDENTITY = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);

  /** The lines of the layers that are on, made when they are first needed. */
  function drawLines(scene) {
    const shown = scene.objects.filter((thing, index) => !isHidden(index));
    scene.lines ??= {
      views: segments(shown.flatMap((thing) => thing.view ?? [])),
      headings: segments(shown.flatMap(headingOf)),
    };
    const layers = [
      ["workspace", outline(scene.workspace), [0.13, 0.55, 0.42]],
      ...Object.entries(scene.regions).filter(([name]) => !hiddenRegions.has(name))
        .map(([name, number]) => ["regions", outline(number), regionColor(name, state.dark)]),
      ["views", scene.lines.views, [0.62, 0.3, 0.75]],
      ["headings", scene.lines.headings, [0.85, 0.25, 0.2]],
      ["trails", trails(scene), [0.36, 0.42, 0.52]],
    ];
    gl.uniformMatrix4fv(plain.places.model, false, IDENTITY);
    // Faintly through what is before them, fully where nothing is.
    for (const [test, alpha] of [[false, 0.25], [true, 0.9]]) {
      if (!test) gl.disable(gl.DEPTH_TEST);
      for (const [layer, lines, color] of layers) {
        if (state.layers[layer] && lines) {
          gl.uniform4f(plain.places.color, ...color, alpha);
          draw(lines, gl.LINES);
        }
      }
      gl.enable(gl.DEPTH_TEST);
    }
    if (state.measured.length === 2) {
      const line = segments([state.measured]);
      gl.disable(gl.DEPTH_TEST);
      gl.uniform4f(plain.places.color, 0.9, 0.2, 0.1, 1);
      draw(line, gl.LINES);
      gl.enable(gl.DEPTH_TEST);
      gl.deleteVertexArray(line.array);
    }
  }

  /** The lines of a region by their number on the page; nothing without a number. */
  function outline(number) {
    if (number === null) return null;
    outlineLines[number] ??= segments(data.outlines[number]);
    return outlineLines[number];
  }
  const outlineLines = [];

  /** The ways of all objects of a simulation up to now. */
  function trails(scene) {
    const { course } = scene;
    if (!course || !state.step) return null;
    const count = scene.objects.length;
    if (!course.trails) {
      const place = (step, index) => course.poses.subarray((step * count + index) * 7, (step * count + index) * 7 + 3);
      const points = new Float32Array(course.steps * count * 6);
      for (let step = 0; step < course.steps; step++) {
        for (let index = 0; index < count; index++) {
          const to = place(step + 1, index);
          const from = Number.isNaN(place(step, index)[0]) ? to : place(step, index);
          if (Number.isNaN(to[0])) continue;
          points.set(from, (step * count + index) * 6);
          points.set(to, (step * count + index) * 6 + 3);
        }
      }
      course.trails = mesh(points, null, Uint32Array.from({ length: points.length / 3 }, (_, i) => i));
    }
    return { array: course.trails.array, count: state.step * count * 2 };
  }

  /** An arrow along an object's heading, above it. */
  function headingOf(thing) {
    const [right, front, top] = rotation(thing.quaternion);
    const base = add(thing.position, times(top, thing.size[2] / 2 + reach * 0.004));
    const length = thing.size[1] / 2 + Math.max(thing.size[1] * 0.4, reach * 0.02);
    const tip = add(base, times(front, length));
    const wing = (side) => add(tip, add(times(front, -0.25 * length), times(right, side * 0.13 * length)));
    return [[base, tip], [wing(-1), tip, wing(1)]];
  }

  /** Where a point is on the canvas, in its pixels; nothing if it is behind the camera. */
  function project(camera, point) {
    const at = (row) => camera[row] * point[0] + camera[4 + row] * point[1] + camera[8 + row] * point[2] + camera[12 + row];
    if (at(3) <= 0) return null;
    return [(0.5 + at(0) / at(3) / 2) * canvas.clientWidth, (0.5 - at(1) / at(3) / 2) * canvas.clientHeight];
  }

  function drawLabels(camera) {
    const marks = [];
    const put = (text, point) => {
      const place = project(camera, point);
      if (!place) return;
      const mark = element("span", text);
      mark.style.left = `${place[0]}px`;
      mark.style.top = `${place[1]}px`;
      marks.push(mark);
    };
    if (state.layers.labels) {
      current().objects.forEach((thing, index) => {
        if (isHidden(index) || index >= 400) return;
        const top = Math.max(...thing.corners.map((corner) => corner[2]));
        put((thing.ego ? "★ " : "") + thing.label, [thing.position[0], thing.position[1], top]);
      });
    }
    if (state.measured.length === 2) {
      const [from, to] = state.measured;
      put(`${number(Math.hypot(...sub(to, from)))} m`, times(add(from, to), 0.5));
    }
    if (marks.length || byId("labels").childElementCount) byId("labels").replaceChildren(...marks);
  }

  /** The point of an object, or of the ground, that is seen at a place of the canvas; nothing if there is none. */
  function pointAt(x, y) {
    const t = Math.tan(FOV / 2);
    const [u, v] = [(2 * x) / canvas.clientWidth - 1, 1 - (2 * y) / canvas.clientHeight];
    const aspect = canvas.width / canvas.height;
    const offset = add(times(rightward(), u * t * aspect), times(upward(), v * t));
    const start = state.flat ? add(eye(), times(offset, view.distance)) : eye();
    const way = state.flat ? ahead() : add(ahead(), offset);
    const index = pick(x, y);
    if (index >= 0) {
      const thing = current().objects[index];
      const inverse = rotation(thing.quaternion).map((axis, k) => times(axis, 1 / thing.size[k]));
      const local = (vector) => inverse.map((axis) => dot(axis, vector));
      const far = firstHit(meshes[thing.mesh], local(sub(start, thing.position)), local(way));
      if (Number.isFinite(far)) return add(start, times(way, far));
    }
    const far = (groundHeight - start[2]) / way[2];
    return far > 0 && Number.isFinite(far) ? add(start, times(way, far)) : null;
  }

  /** How far along a ray a mesh is first met (Moeller and Trumbore). */
  function firstHit({ points, indices }, start, way) {
    const corner = (k) => [points[3 * indices[k]], points[3 * indices[k] + 1], points[3 * indices[k] + 2]];
    let best = Infinity;
    for (let k = 0; k < indices.length; k += 3) {
      const a = corner(k);
      const [ab, ac] = [sub(corner(k + 1), a), sub(corner(k + 2), a)];
      const p = cross(way, ac);
      const determinant = dot(ab, p);
      if (Math.abs(determinant) < 1e-14) continue;
      const offset = sub(start, a);
      const u = dot(offset, p) / determinant;
      const q = cross(offset, ab);
      const v = dot(way, q) / determinant;
      const far = dot(ac, q) / determinant;
      if (u >= 0 && v >= 0 && u + v <= 1 && far > 0 && far < best) best = far;
    }
    return best;
  }

  /** The index of the object at a place of the canvas, -1 for none. */
  function pick(x, y) {
    const ratio = canvas.width / Math.max(canvas.clientWidth, 1);
    const [width, height] = [canvas.width, canvas.height];
    gl.bindFramebuffer(gl.FRAMEBUFFER, pickTarget);
    if (pickSize[0] !== width || pickSize[1] !== height) {
      pickSize = [width, height];
      for (const [buffer, format, attachment] of [
        [pickColor, gl.RGBA8, gl.COLOR_ATTACHMENT0], [pickDepth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT],
      ]) {
        gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
        gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
        gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, buffer);
      }
      pickOf = "";
    }
    const camera = viewCamera();
    const key = [state.scene, state.step, ...hidden, ...camera].join();
    if (key !== pickOf) {
      pickOf = key;
      gl.viewport(0, 0, width, height);
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.useProgram(plain.made);
      gl.uniformMatrix4fv(plain.places.camera, false, camera);
      current().objects.forEach((thing, index) => {
        if (isHidden(index)) return;
        const code = index + 1;
        gl.uniformMatrix4fv(plain.places.model, false, thing.model);
        gl.uniform4f(plain.places.color, (code & 255) / 255, ((code >> 8) & 255) / 255, (code >> 16) / 255, 1);
        draw(meshes[thing.mesh]);
      });
    }
    const pixel = new Uint8Array(4);
    gl.readPixels(Math.floor(x * ratio), height - 1 - Math.floor(y * ratio), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return pixel[0] + (pixel[1] << 8) + (pixel[2] << 16) - 1;
  }

  // ---- Page -----------------------------------------------------------------------------------------------------

  const number = (value) => (Math.abs(value) >= 1e5 ? value.toExponential(2) : String(Number(value.toFixed(3))));
  const triple = (values) => `(${values.map(number).join(", ")})`;
  const degrees = (values) => triple(values.map((value) => Number(((value * 180) / Math.PI).toFixed(2)))) + "°";
  const element = (kind, text, attributes = {}) =>
    Object.assign(document.createElement(kind), { textContent: text, ...attributes });
  const css = (color) => `rgb(${color.slice(0, 3).map((value) => Math.round(value * 255)).join(" ")})`;

  function show(index) {
    const same = current().objects[state.chosen]?.label;
    state.scene = Math.max(0, Math.min(data.scenes.length - 1, index));
    const scene = current();
    // The selection stays with the object of the same place and name.
    if (scene.objects[state.chosen]?.label !== same) state.chosen = -1;
    state.near = -1;
    byId("slider").value = state.scene;
    byId("previous").disabled = state.scene === 0;
    byId("next").disabled = state.scene === data.scenes.length - 1;
    const params = Object.entries(scene.params).map(([name, value]) => ` · ${name} = ${value}`).join("");
    const outcome = scene.course ? scene.course.reason : `${scene.attempts} ${scene.attempts === 1 ? "attempt" : "attempts"}`;
    byId("facts").textContent =
      `${scene.course ? "Simulation" : "Scene"} ${state.scene + 1} of ${data.scenes.length} · ` +
      `seed ${scene.seed}, k ${scene.k} · ${outcome}${params}`;
    showCourse(scene);
    const list = byId("objects");
    const scrolled = list.scrollTop;
    list.replaceChildren(...scene.objects.map((thing, k) => {
      const row = element("li", "", { tabIndex: 0 });
      const swatch = element("i", "");
      swatch.style.background = css(thing.color);
      row.append(swatch, element("span", (thing.ego ? "★ " : "") + thing.label), element("small", thing.class === thing.label ? "" : thing.class));
      row.addEventListener("pointerenter", () => { state.near = k; mark(); });
      row.addEventListener("pointerleave", () => { state.near = -1; mark(); });
      row.addEventListener("click", () => choose(state.chosen === k ? -1 : k));
      row.addEventListener("keydown", (event) => { if (event.key === "Enter") choose(k); });
      row.addEventListener("dblclick", () => { choose(k); frame(thing.corners); });
      return row;
    }));
    list.scrollTop = scrolled;
    choose(state.chosen);
    state.measured = [];
    history.replaceState(null, "", `#k=${scene.k}`);
  }

  /** Shows the time line and the requirements of a simulation, which begins anew. */
  function showCourse(scene) {
    run(false);
    const { course } = scene;
    byId("clock").hidden = !course;
    document.querySelector('[data-layer="trails"]').parentElement.hidden = !course;
    document.querySelector('[data-layer="ground"]').parentElement.hidden = !data.grounds;
    byId("follow").hidden = !course;
    byId("verdicts").replaceChildren(...(course ? course.requirements : []).map(({ label, verdict, robustness }) => {
      const row = element("li", "", { className: verdict.replaceAll(" ", "-") });
      const by = typeof robustness === "number" ? `, by ${number(robustness)}` : "";
      row.append(element("span", label), element("small", verdict + by));
      return row;
    }));
    if (!course) return;
    byId("time").max = course.steps;
    at(0);
  }

  /** Shows the present simulation after so many steps. */
  function at(step) {
    const scene = current();
    if (!scene.course) return;
    const before = scene.objects[state.chosen]?.position;
    const heading = scene.objects[state.chosen]?.euler[0];
    state.step = Math.max(0, Math.min(scene.course.steps, step));
    settleAll(scene, state.step);
    if (state.following && before) {
      view.target = add(view.target, sub(scene.objects[state.chosen].position, before));
      if (state.behind) view.azimuth -= scene.objects[state.chosen].euler[0] - heading;
    }
    scene.lines = null;
    shadowsOf = -1;
    byId("time").value = state.step;
    byId("now").textContent = `${(state.step * scene.course.timestep).toFixed(2)} s, step ${state.step} of ${scene.course.steps}`;
    if (byId("objects").childElementCount === scene.objects.length) choose(state.chosen);
    changed();
  }

  /** Lets the time of the present simulation run, as fast as it is or by a factor, to its end. */
  function run(on) {
    cancelAnimationFrame(state.running);
    state.running = 0;
    const { course } = current();
    if (on && course) {
      if (state.step >= course.steps) at(0);
      let before = performance.now();
      let time = state.step * course.timestep;
      const tick = (now) => {
        time += ((now - before) / 1000) * Number(byId("speed").value);
        before = now;
        const step = Math.floor(time / course.timestep + 1e-9);
        if (step !== state.step) at(step);
        if (state.step >= course.steps) run(false);
        else state.running = requestAnimationFrame(tick);
      };
      state.running = requestAnimationFrame(tick);
    }
    byId("run").textContent = state.running ? "❚❚" : "▶";
    byId("run").setAttribute("aria-label", state.running ? "Pause" : "Play the simulation");
  }

  /** Shows in the list which object is near the pointer and which is selected. */
  function mark() {
    [...byId("objects").children].forEach((row, k) => {
      row.classList.toggle("near", k === state.near);
      row.classList.toggle("chosen", k === state.chosen);
      row.classList.toggle("hidden", isHidden(k));
    });
    changed();
  }

  function choose(index) {
    state.chosen = index;
    const details = byId("details");
    details.hidden = index < 0;
    for (const name of ["focus", "hide", "isolate"]) byId(name).disabled = index < 0;
    if (index >= 0) {
      const thing = current().objects[index];
      const table = element("dl", "");
      for (const [name, value] of [
        ["class", thing.class], ["position", triple(thing.position) + " m"],
        ["yaw, pitch, roll", degrees(thing.euler)], ["size", triple(thing.size) + " m"],
        ...Object.entries(thing.more),
      ]) table.append(element("dt", name), element("dd", String(value)));
      details.replaceChildren(element("h2", thing.label), table);
      byId("objects").children[index].scrollIntoView({ block: "nearest" });
    }
    mark();
  }

  function tip(index, x, y) {
    const box = byId("tip");
    box.hidden = index < 0;
    if (index < 0) return;
    const thing = current().objects[index];
    const title = thing.label === thing.class ? thing.class : `${thing.label} (${thing.class})`;
    box.textContent = `${title}\n${triple(thing.position)} m`;
    box.style.left = `${Math.min(x + 14, canvas.clientWidth - box.offsetWidth - 4)}px`;
    box.style.top = `${Math.min(y + 14, canvas.clientHeight - box.offsetHeight - 4)}px`;
  }

  function drawCompass() {
    const axes = [["X", [1, 0, 0], "#d4483b"], ["Y", [0, 1, 0], "#3d9a4b"], ["Z", [0, 0, 1], "#3a77d0"]];
    const [right, up, front] = [rightward(), upward(), ahead()];
    const drawn = axes.map(([name, axis, color]) => ({ name, color, x: dot(axis, right), y: dot(axis, up), z: dot(axis, front) }))
      .sort((a, b) => b.z - a.z)
      .map(({ name, color, x, y }) =>
        `<line x1="0" y1="0" x2="${x * 26}" y2="${-y * 26}" stroke="${color}" stroke-width="2.5" stroke-linecap="round"/>` +
        `<text x="${x * 33}" y="${-y * 33}" fill="${color}" text-anchor="middle" dominant-baseline="central">${name}</text>`)
      .join("");
    byId("compass").innerHTML = `<svg viewBox="-40 -40 80 80">${drawn}</svg>`;
  }

  function setTheme(dark) {
    state.dark = dark;
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    listRegions();
    changed();
  }

  function play(on) {
    clearInterval(state.playing);
    state.playing = on && data.scenes.length > 1
      ? setInterval(() => show((state.scene + 1) % data.scenes.length), 900) : 0;
    byId("play").textContent = state.playing ? "❚❚" : "▶";
    byId("play").setAttribute("aria-label", state.playing ? "Pause" : "Play");
  }

  /** Straight from above and without perspective, as on a map. */
  function fromAbove() {
    view.azimuth = 0;
    view.elevation = Math.PI / 2;
    state.flat = true;
    wholeScene();
  }

  function changeHidden(change) {
    change();
    for (const scene of data.scenes) scene.lines = null;
    shadowsOf = -1;
    mark();
  }

  const hideChosen = () => {
    if (state.chosen < 0) return;
    const key = keyOf(current().objects[state.chosen], state.chosen);
    changeHidden(() => { if (!hidden.delete(key)) hidden.add(key); });
  };
  const isolate = () => {
    if (state.chosen < 0) return;
    changeHidden(() => current().objects.forEach((thing, index) => {
      if (index === state.chosen) hidden.delete(keyOf(thing, index));
      else hidden.add(keyOf(thing, index));
    }));
  };
  const reveal = () => changeHidden(() => hidden.clear());

  function setMeasuring(on) {
    state.measuring = on;
    state.measured = [];
    byId("measure").setAttribute("aria-pressed", String(on));
    changed();
  }

  function setLayer(name, on) {
    state.layers[name] = on;
    document.querySelector(`[data-layer="${name}"]`).checked = on;
    byId("regions").hidden = !state.layers.regions;
    changed();
  }

  /** A box to tick for each region, in its colour. */
  function listRegions() {
    byId("regions").replaceChildren(...regionNames.map((name) => {
      const box = element("input", "", { type: "checkbox", checked: !hiddenRegions.has(name) });
      const row = element("label", "");
      box.style.accentColor = css(regionColor(name, state.dark));
      box.addEventListener("change", () => {
        if (box.checked) hiddenRegions.delete(name); else hiddenRegions.add(name);
        changed();
      });
      row.append(box, name);
      return row;
    }));
  }

  function savePng() {
    render(); // what is drawn can be read only before the browser shows it
    canvas.toBlob((blob) => {
      const link = element("a", "", { href: URL.createObjectURL(blob), download: `scene-${current().k}.png` });
      link.click();
      URL.revokeObjectURL(link.href);
    });
  }

  function fromTheSide() {
    view.azimuth = (-35 * Math.PI) / 180;
    view.elevation = (33 * Math.PI) / 180;
    state.flat = false;
    wholeScene();
  }

  /** Lets the view go with the selected object. */
  function follow(on) {
    state.following = on;
    state.behind = false;
    byId("follow").setAttribute("aria-pressed", String(on));
  }

  /** Lets the view stay behind the object with a label, or a number. */
  function stayBehind(name) {
    const things = current().objects;
    const index = things.findIndex((thing, k) => thing.label === name || (name === "ego" && thing.ego) || String(k) === name);
    if (index < 0) return;
    const { position, euler, size } = things[index];
    choose(index);
    follow(true);
    state.behind = true;
    view.azimuth = -euler[0];
    view.elevation = (22 * Math.PI) / 180;
    const around = Math.max(5, 2.5 * Math.max(...size));
    const ahead = times([-Math.sin(euler[0]), Math.cos(euler[0]), 0], 0.75 * around);
    frame([[1, 1], [1, -1], [-1, 1], [-1, -1]].map(([x, y]) => add(position, add(ahead, [0.8 * x * around, 0.8 * y * around, 0]))));
  }

  const focus = () => { if (state.chosen >= 0) frame(current().objects[state.chosen].corners); };

  byId("slider").max = data.scenes.length - 1;
  byId("stepper").hidden = data.scenes.length === 1;
  if (data.scenes.length === 1) byId("stepper").style.display = "none";
  byId("slider").addEventListener("input", (event) => show(Number(event.target.value)));
  byId("previous").addEventListener("click", () => show(state.scene - 1));
  byId("next").addEventListener("click", () => show(state.scene + 1));
  byId("play").addEventListener("click", () => play(!state.playing));
  byId("time").addEventListener("input", (event) => { run(false); at(Number(event.target.value)); });
  byId("run").addEventListener("click", () => run(!state.running));
  byId("theme").addEventListener("click", () => setTheme(!state.dark));
  byId("whole").addEventListener("click", fromTheSide);
  byId("above").addEventListener("click", fromAbove);
  byId("focus").addEventListener("click", focus);
  byId("follow").addEventListener("click", () => follow(!state.following));
  byId("refit").addEventListener("click", refit);
  byId("hide").addEventListener("click", hideChosen);
  byId("isolate").addEventListener("click", isolate);
  byId("reveal").addEventListener("click", reveal);
  byId("measure").addEventListener("click", () => setMeasuring(!state.measuring));
  byId("export").addEventListener("click", savePng);
  for (const box of document.querySelectorAll("[data-layer]")) {
    box.addEventListener("change", () => setLayer(box.dataset.layer, box.checked));
  }

  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const typing = event.target.tagName === "INPUT" || event.target.tagName === "BUTTON";
    const actions = {
      ArrowLeft: () => show(state.scene - 1), ArrowRight: () => show(state.scene + 1),
      PageUp: () => show(state.scene - 10), PageDown: () => show(state.scene + 10),
      Home: () => show(0), End: () => show(data.scenes.length - 1),
      " ": () => (current().course ? run(!state.running) : play(!state.playing)),
      ",": () => { run(false); at(state.step - 1); }, ".": () => { run(false); at(state.step + 1); }, 0: fromTheSide, 5: fromAbove, f: focus,
      g: () => setLayer("grid", !state.layers.grid), l: () => setLayer("labels", !state.layers.labels),
      r: refit, c: () => follow(!state.following), h: hideChosen, i: isolate, u: reveal, m: () => setMeasuring(!state.measuring), p: savePng,
      t: () => setTheme(!state.dark), Escape: () => (state.measuring ? setMeasuring(false) : choose(-1)),
    };
    const action = actions[event.key];
    if (!action || (typing && (event.key === " " || event.target.type === "range"))) return;
    event.preventDefault();
    action();
  });

  // ---- Mouse and touch ------------------------------------------------------------------------------------------

  const pointers = new Map();
  let travelled = 0;

  function turn(dx, dy) {
    state.flat = false;
    view.azimuth += dx * 0.008;
    view.elevation = Math.max(-1.55, Math.min(Math.PI / 2 - 1e-3, view.elevation + dy * 0.008));
    changed();
  }

  function move(dx, dy) {
    const scale = (2 * view.distance * Math.tan(FOV / 2)) / Math.max(canvas.clientHeight, 1);
    view.target = add(view.target, add(times(rightward(), -dx * scale), times(upward(), dy * scale)));
    changed();
  }

  /** Zooms by a factor, so that what is under the place (x, y) stays there. */
  function zoom(factor, x, y) {
    const distance = Math.max(reach * 1e-3, Math.min(reach * 60, view.distance * factor));
    const scale = (2 * (view.distance - distance) * Math.tan(FOV / 2)) / Math.max(canvas.clientHeight, 1);
    const [dx, dy] = [x - canvas.clientWidth / 2, canvas.clientHeight / 2 - y];
    view.target = add(view.target, add(times(rightward(), dx * scale), times(upward(), dy * scale)));
    view.distance = distance;
    changed();
  }

  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.offsetX, y: event.offsetY, button: event.button, shift: event.shiftKey });
    travelled = 0;
    tip(-1);
  });
  canvas.addEventListener("pointermove", (event) => {
    const [x, y] = [event.offsetX, event.offsetY];
    const pointer = pointers.get(event.pointerId);
    if (!pointer) {
      const near = pick(x, y);
      tip(near, x, y);
      if (near !== state.near) {
        state.near = near;
        mark();
      }
      return;
    }
    const [dx, dy] = [x - pointer.x, y - pointer.y];
    travelled += Math.abs(dx) + Math.abs(dy);
    if (pointers.size === 1) {
      if (pointer.button === 0 && !pointer.shift) turn(dx, dy);
      else move(dx, dy);
    } else if (pointers.size === 2) {
      const other = [...pointers.entries()].find(([id]) => id !== event.pointerId)[1];
      const before = Math.hypot(pointer.x - other.x, pointer.y - other.y);
      const after = Math.hypot(x - other.x, y - other.y);
      if (before > 0 && after > 0) zoom(before / after, (x + other.x) / 2, (y + other.y) / 2);
      move(dx / 2, dy / 2);
    }
    pointer.x = x;
    pointer.y = y;
  });
  const release = (event) => {
    const pointer = pointers.get(event.pointerId);
    pointers.delete(event.pointerId);
    if (event.type === "pointerup" && pointer && travelled < 5 && pointer.button === 0) {
      if (state.measuring) {
        const point = pointAt(event.offsetX, event.offsetY);
        if (point) state.measured = [...state.measured.slice(state.measured.length % 2 ? 0 : 2), point];
        changed();
        return;
      }
      const index = pick(event.offsetX, event.offsetY);
      choose(index === state.chosen ? -1 : index);
    }
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("pointerleave", () => {
    tip(-1);
    state.near = -1;
    mark();
  });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    zoom(Math.exp(Math.max(-120, Math.min(120, event.deltaY * lines)) * 0.0015), event.offsetX, event.offsetY);
  }, { passive: false });
  canvas.addEventListener("dblclick", (event) => {
    const index = pick(event.offsetX, event.offsetY);
    if (index >= 0) {
      choose(index);
      focus();
    }
  });
  canvas.addEventListener("webglcontextlost", () => {
    byId("trouble").hidden = false;
    byId("trouble").textContent = "The graphics of this page were reset; load it again.";
  });
  // Until somebody uses the page, all that there is stays in view: frames get their size late.
  let used = false;
  for (const kind of ["pointerdown", "wheel", "keydown"]) {
    window.addEventListener(kind, () => { used = true; }, { passive: true, capture: true });
  }
  new ResizeObserver(() => (used ? changed() : wholeScene())).observe(canvas);

  setTheme(window.matchMedia?.("(prefers-color-scheme: dark)").matches ?? false);
  const byNumber = () => {
    const asked = /^#k=(\d+)(?:&|$)/.exec(location.hash);
    return asked ? data.scenes.findIndex((scene) => String(scene.k) === asked[1]) : -1;
  };
  window.addEventListener("hashchange", () => { if (byNumber() >= 0) show(byNumber()); });
  const start = /[#&]t=([\d.]+)/.exec(location.hash);
  const followed = /[#&]follow=([^&]+)/.exec(location.hash);
  if (data.scenes.some((scene) => scene.course)) {
    for (const [name, word] of [["previous", "Previous"], ["next", "Next"]]) {
      byId(name).title = byId(name).title.replace(/.* scene/, `${word} simulation`);
    }
    byId("play").hidden = true;
  }
  show(Math.max(byNumber(), 0));
  if (start && current().course) at(Math.round(Number(start[1]) / current().course.timestep));
  wholeScene();
  // The canvas has its size, and the view its first picture, before the view goes with an object.
  if (followed && current().course) requestAnimationFrame(() => { used = true; stayBehind(decodeURIComponent(followed[1])); });
})();
