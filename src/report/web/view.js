"use strict";
// The map in three dimensions. Drawn only when something has changed, and with fewer points while it turns where that
// would be slow.

/** How long a frame may take while the view moves (ms): thirty a second with some to spare. */
const FRAME_MS = 26;
/** How long after the last movement all is drawn again (ms). */
const REST_MS = 160;

/** Whether a processor draws instead of a graphics card: smooth edges would cost too much. */
function isSoftware() {
  const probe = document.createElement("canvas").getContext("webgl2");
  const about = probe?.getExtension("WEBGL_debug_renderer_info");
  const name = about ? probe.getParameter(about.UNMASKED_RENDERER_WEBGL) : "";
  probe?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

/** The same points in an order in which the first of them are everywhere. */
function mixed(count, ...arrays) {
  // A stride near the golden section that has no part in common with the count visits each point once.
  const common = (a, b) => (b ? common(b, a % b) : a);
  let stride = Math.max(1, Math.floor(0.618 * count));
  while (common(stride, count) > 1) stride += 1;
  return arrays.map((array) => {
    const result = new array.constructor(array.length);
    for (let i = 0, from = 0; i < count; i += 1, from = (from + stride) % count) result.set(array.subarray(3 * from, 3 * from + 3), 3 * i);
    return result;
  });
}

class View {
  constructor(canvas, names) {
    this.canvas = canvas;
    this.names = names;
    const antialias = !isSoftware();
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias, powerPreference: "high-performance" });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(50, 1, 0.02, 500);
    this.camera.up.set(0, 0, 1);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.screenSpacePanning = true;
    this.controls.addEventListener("change", () => this.move());
    this.layers = {};
    this.objects = [];
    this.selected = null;
    this.frames = 0;
    this.quality = 1;
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8890a0, 2.2));
    const sun = new THREE.DirectionalLight(0xffffff, 1.6);
    sun.position.set(2, -3, 6);
    this.scene.add(sun);
    this.addFixed();
    this.addObjects();
    this.addCamera();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
    this.fit();
  }

  invalidate() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame((now) => { this.waiting = false; this.pace(now); this.draw(); });
  }

  /** The view moves: until it rests, frames come before details. */
  move() {
    this.moving = true;
    clearTimeout(this.resting);
    this.resting = setTimeout(() => { this.moving = false; this.drawnAt = null; this.invalidate(); }, REST_MS);
    this.invalidate();
  }

  /** Takes from or adds to the details by how long frames take. */
  pace(now) {
    if (this.moving && this.drawnAt) {
      const factor = Math.min(1.15, Math.max(0.4, FRAME_MS / (now - this.drawnAt)));
      this.quality = Math.min(1, Math.max(0.01, this.quality * factor));
    }
    this.drawnAt = this.moving ? now : null;
    const quality = this.moving ? this.quality : 1;
    this.points.geometry.setDrawRange(0, Math.ceil(quality * run.points.count));
    // With many objects and hardly a point left to leave out, their wires have to do.
    const plain = quality < 0.1 && this.objects.length > MANY;
    for (const kind of this.kinds.values()) kind.solids.drawn.material.visible = !plain;
    this.hurries = quality < 0.1;
    // In steps, each of which makes new buffers.
    const coarser = [[0.7, 1], [0.4, 0.75], [0.1, 0.5], [0, 0.4]].find(([least]) => quality >= least)[1];
    const ratio = Math.min(window.devicePixelRatio, 2) * coarser;
    if (ratio !== this.renderer.getPixelRatio()) this.renderer.setPixelRatio(ratio);
  }

  draw() {
    this.renderer.render(this.scene, this.camera);
    this.frames += 1;
    this.drawNames();
  }

  /** What is asked of the graphics card for a frame. */
  get drawCalls() {
    return this.renderer.info.render.calls;
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    const ratio = Math.min(window.devicePixelRatio, 2);
    this.names.width = width * ratio;
    this.names.height = height * ratio;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }

  /** A part of the scene that can be switched. */
  layer(name, ...parts) {
    this.layers[name] = this.layers[name] || [];
    for (const part of parts) {
      this.layers[name].push(part);
      this.scene.add(part);
    }
  }

  show(name, visible) {
    for (const part of this.layers[name] || []) part.visible = visible;
    if (name === "names") this.hidesNames = !visible;
    this.invalidate();
  }

  addFixed() {
    this.addPoints();
    this.addPlanes();
    this.layer("walls", this.wallsOf(run.walls));
    const odom = new THREE.Matrix4();
    if (run.odom) {
      odom.compose(new THREE.Vector3(...run.odom.slice(0, 3)), new THREE.Quaternion(...run.odom.slice(3)), new THREE.Vector3(1, 1, 1));
    }
    const before = run.way.map((pose) => new THREE.Vector3(...pose.slice(4)).applyMatrix4(odom));
    this.layer("odometry", ...this.ribbon(before, "#d55e00"));
    this.layer("way", ...this.ribbon(run.way.map((pose) => new THREE.Vector3(...pose.slice(1, 4))), "#0f8fd6"));
    if (!run.truth) return;
    const bodies = run.truth.objects.map((object) => ({ ...object, semi_axes: object.size.map((size) => size / 2) }));
    this.truth = new Wires(wireOf("cuboid"), bodies.length);
    this.truth.set(bodies.map(placeOf), bodies.map(() => [0.5, 0.5, 0.5]));
    this.truthWay = this.line(run.truth.way.map((at) => new THREE.Vector3(...at)), "#808080");
    this.layer("truth", this.truth.drawn, this.truthWay);
  }

  line(points, color) {
    const geometry = new THREE.BufferGeometry().setFromPoints(points);
    return new THREE.Line(geometry, new THREE.LineBasicMaterial({ color }));
  }

  /** A way as a flat band, a little above the floor, and a line that is seen from the side, too. */
  ribbon(points, color) {
    const lifted = points.map((point) => point.clone().setZ(point.z + 0.03));
    const corners = [];
    // Corners of the band up to each pose.
    const until = [0];
    for (let i = 0; i + 1 < lifted.length; i += 1) {
      const [from, to] = [lifted[i], lifted[i + 1]];
      const across = new THREE.Vector3(from.y - to.y, to.x - from.x, 0);
      until.push(corners.length + (across.length() < 1e-4 ? 0 : 6));
      if (across.length() < 1e-4) continue;
      across.setLength(0.018);
      const [a, b, c, d] = [from.clone().add(across), from.clone().sub(across), to.clone().add(across), to.clone().sub(across)];
      corners.push(a, b, c, b, d, c);
    }
    const material = new THREE.MeshBasicMaterial({ color, side: THREE.DoubleSide });
    const band = new THREE.Mesh(new THREE.BufferGeometry().setFromPoints(corners), material);
    const line = this.line(lifted, color);
    band.frustumCulled = false;
    line.frustumCulled = false;
    this.ribbons = [...(this.ribbons || []), { band, line, until }];
    return [band, line];
  }

  addPoints() {
    const { count, positions, colors, origin, step_m: step } = run.points;
    const geometry = new THREE.BufferGeometry();
    const steps = new Uint16Array(bytesOf(positions).buffer);
    const shades = colors ? bytesOf(colors) : new Uint8Array(3 * count);
    let high = 0;
    for (let i = 2; i < steps.length; i += 3) high = Math.max(high, steps[i]);
    if (!colors) {
      for (let i = 0; i < count; i += 1) shades.fill(80 + (150 * steps[3 * i + 2]) / Math.max(high, 1), 3 * i, 3 * i + 3);
    }
    const [mixedSteps, mixedShades] = mixed(count, steps, shades);
    geometry.setAttribute("position", new THREE.BufferAttribute(mixedSteps, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(mixedShades, 3, true));
    const material = new THREE.ShaderMaterial({
      uniforms: { size: { value: 1.5 * run.points.voxel_m }, height: { value: 1 } },
      vertexShader: `attribute vec3 color; uniform float size; uniform float height; varying vec3 shade;
        void main() {
          shade = color;
          vec4 at = modelViewMatrix * vec4(position, 1.0);
          gl_Position = projectionMatrix * at;
          gl_PointSize = clamp(size * height / -at.z, 1.0, 14.0);
        }`,
      fragmentShader: "varying vec3 shade; void main() { gl_FragColor = vec4(shade, 1.0); }",
    });
    const points = new THREE.Points(geometry, material);
    points.onBeforeRender = (renderer) => {
      const size = renderer.getDrawingBufferSize(new THREE.Vector2());
      material.uniforms.height.value = size.y / (2 * Math.tan((this.camera.fov * Math.PI) / 360));
    };
    points.position.set(...origin);
    points.scale.setScalar(step);
    points.frustumCulled = false;
    this.layer("points", points);
    this.points = points;
    this.placed = { steps, origin, step };
  }

  /** Heights at which planes were seen often, and where points lie in them: squares of ten centimetres. */
  addPlanes() {
    const heights = [];
    const seen = run.steps.flatMap((step) => step.planes_m).sort((a, b) => a - b);
    for (let first = 0, i = 1; i <= seen.length; i += 1) {
      if (i < seen.length && seen[i] - seen[i - 1] < 0.03) continue;
      if (i - first >= Math.min(3, run.steps.length)) heights.push(seen[(first + i) >> 1]);
      first = i;
    }
    const cell = 0.1;
    const { steps, origin, step } = this.placed;
    const cells = new Map();
    for (let i = 0; i < steps.length; i += 3) {
      const z = origin[2] + step * steps[i + 2];
      const height = heights.find((h) => Math.abs(h - z) < 0.025);
      if (height === undefined) continue;
      const [x, y] = [0, 1].map((axis) => Math.floor((origin[axis] + step * steps[i + axis]) / cell));
      const key = `${height} ${x} ${y}`;
      cells.set(key, (cells.get(key) || 0) + 1);
    }
    const places = [];
    for (const [key, count] of cells) {
      if (count < 2) continue;
      const [height, x, y] = key.split(" ").map(Number);
      places.push(new THREE.Matrix4().makeTranslation((x + 0.5) * cell, (y + 0.5) * cell, height).scale(new THREE.Vector3(cell, cell, 1)));
    }
    const squares = new Solids(new THREE.PlaneGeometry(1, 1), places.length, 0.35);
    squares.drawn.material.polygonOffset = true;
    squares.drawn.material.polygonOffsetFactor = -1;
    squares.set(places, places.map(() => [0.35, 0.62, 0.95]));
    this.layer("planes", squares.drawn);
    this.floor = heights.length ? heights[0] : Math.min(0, ...map.objects.map((o) => o.position[2] - o.semi_axes[2]));
  }

  /** All walls as one body, from the floor to the height of a man. */
  wallsOf(walls) {
    const low = this.floor || 0;
    const corners = walls.flatMap(([[x0, y0], [x1, y1]]) => {
      const [a, b, c, d] = [[x0, y0, low], [x1, y1, low], [x1, y1, low + 1.6], [x0, y0, low + 1.6]];
      return [a, b, c, a, c, d].flat();
    });
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(corners, 3));
    return new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: "#7f8ea3", transparent: true, opacity: 0.3, side: THREE.DoubleSide, depthWrite: false }));
  }

  addObjects() {
    expectObjects(Math.max(map.objects.length, trackList.length));
    const kinds = new Map();
    for (const { outline } of [...map.objects, ...trackList]) {
      const key = outlineKey(outline);
      kinds.set(key, { outline, count: (kinds.get(key)?.count || 0) + 1 });
    }
    this.kinds = new Map();
    let all = 1;
    for (const [key, { outline, count }] of kinds) {
      const kind = { solids: new Solids(solidOf(outline), count, 0.42), wires: new Wires(wireOf(outline), count) };
      this.kinds.set(key, kind);
      this.layer("outlines", kind.solids.drawn, kind.wires.drawn);
      all += count;
    }
    this.boxes = new Wires(wireOf("cuboid"), all, 0.8);
    this.layer("boxes", this.boxes.drawn);
    this.spread = new Solids(new THREE.SphereGeometry(1, 14, 10), all, 0.4);
    this.grown = new Wires(wireOf("cuboid"), all, 0.55);
    this.layer("uncertainty", this.spread.drawn, this.grown.drawn);
    this.chosen = new Wires(wireOf("cuboid"), 1);
    this.scene.add(this.chosen.drawn);
  }

  addCamera() {
    const lines = new THREE.BufferGeometry();
    lines.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * 16), 3));
    this.frustum = new THREE.LineSegments(lines, new THREE.LineBasicMaterial({ color: "#e69f00" }));
    this.frustum.frustumCulled = false;
    this.layer("camera", this.frustum);
  }

  /** Shows objects, and the camera of a step. */
  setStep(objects, step) {
    this.objects = objects;
    const byKind = new Map([...this.kinds.keys()].map((key) => [key, []]));
    for (const object of objects) byKind.get(outlineKey(object.outline))?.push(object);
    for (const [key, kind] of this.kinds) {
      const of = byKind.get(key);
      const places = of.map(placeOf);
      kind.solids.set(places, of.map((object) => tintOf(colorOf(object.label))));
      kind.wires.set(places, of.map((object) => inkOf(colorOf(object.label))));
    }
    this.boxes.set(objects.map(placeOf), objects.map((object) => inkOf(colorOf(object.label))));
    this.setUncertainty(objects);
    this.setWays(timeOf(step));
    this.setFrustum(step);
    this.select(this.selected);
  }

  /** Ways up to a time. */
  setWays(t) {
    let poses = 0;
    while (poses < run.way.length && run.way[poses][0] <= t + 1e-6) poses += 1;
    for (const { band, line, until } of this.ribbons) {
      band.geometry.setDrawRange(0, until[Math.max(poses - 1, 0)] || 0);
      line.geometry.setDrawRange(0, poses);
    }
  }

  /** Two standard deviations of the place, and of each face, as they were known at the time. */
  setUncertainty(objects) {
    const spreads = objects.map((object) => placeOf({ ...object, semi_axes: object.sigmas.slice(0, 3).map((of) => Math.max(2 * of, 1e-3)) }));
    const grown = objects.map((object) => {
      const half = object.semi_axes.map((size, axis) => size + 2 * Math.hypot(object.sigmas[axis], size * object.sigmas[3 + axis]));
      return placeOf({ ...object, semi_axes: half });
    });
    this.spread.set(spreads, objects.map(() => [0.9, 0.2, 0.2]));
    this.grown.set(grown, objects.map((object) => inkOf(colorOf(object.label))));
  }

  setFrustum(step) {
    const at = stepOf(step);
    this.frustum.visible = Boolean(at) && !this.hidesCamera;
    if (!at) return;
    const matrix = new THREE.Matrix4().compose(
      new THREE.Vector3(...at.camera.slice(0, 3)), new THREE.Quaternion(...at.camera.slice(3)), new THREE.Vector3(1, 1, 1),
    );
    const [width, height] = at.size.map((size) => (0.3 * size) / (2 * at.focal_px));
    const corners = [[-width, -height], [width, -height], [width, height], [-width, height]];
    const points = [];
    corners.forEach(([x, y], i) => {
      const [nextX, nextY] = corners[(i + 1) % 4];
      points.push([0, 0, 0], [x, y, 0.3], [x, y, 0.3], [nextX, nextY, 0.3]);
    });
    points.forEach((point, i) => this.frustum.geometry.attributes.position.setXYZ(i, ...new THREE.Vector3(...point).applyMatrix4(matrix).toArray()));
    this.frustum.geometry.attributes.position.needsUpdate = true;
    this.pose = { matrix, fov: (360 / Math.PI) * Math.atan(at.size[1] / (2 * at.focal_px)) };
    if (this.follows) this.lookThrough();
  }

  /** Marks an object; an identity that is not there unmarks. */
  select(id) {
    this.selected = id;
    const object = this.objects.find((one) => one.id === id);
    this.chosen.set(object ? [placeOf({ ...object, semi_axes: object.semi_axes.map((half) => half + 0.012) })] : [], object ? [this.ink] : []);
    this.invalidate();
  }

  /** The pointer is at a place of the canvas (px), or not over it: what is there gets its name. */
  pointAt(x, y) {
    this.pointer = x === undefined ? null : [x, y];
    if (this.pointing) return;
    this.pointing = true;
    requestAnimationFrame(() => {
      this.pointing = false;
      const id = this.pointer && this.objectAt(...this.pointer);
      if (id === this.pointed) return;
      this.pointed = id;
      this.invalidate();
    });
  }

  /** The nearest object at a place of the canvas (px). */
  objectAt(x, y) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2((2 * x) / width - 1, 1 - (2 * y) / height), this.camera);
    let best = { distance: Infinity, volume: Infinity, id: null };
    for (const object of this.objects) {
      const distance = entry(caster.ray, object);
      // What stands inside of something else, a cup on a desk's box, is meant rather than that.
      const volume = object.semi_axes.reduce((product, half) => product * half, 1);
      if (distance !== null && (distance < best.distance - 0.3 || (distance < best.distance + 0.3 && volume < best.volume))) best = { distance, volume, id: object.id };
    }
    return best.id;
  }

  /** Where an object is on the canvas (px); for tests. */
  place(id) {
    const object = this.objects.find((one) => one.id === id);
    const at = new THREE.Vector3(...object.position).project(this.camera);
    return [((at.x + 1) / 2) * this.canvas.clientWidth, ((1 - at.y) / 2) * this.canvas.clientHeight];
  }

  theme(dark) {
    this.renderer.setClearColor(dark ? "#101317" : "#f4f6f8");
    this.ink = dark ? [1, 1, 1] : [0.05, 0.08, 0.12];
    const truth = dark ? 0.95 : 0.1;
    if (this.truth) {
      this.truth.tint.array.fill(truth);
      this.truth.tint.needsUpdate = true;
      this.truthWay.material.color.setScalar(truth);
    }
    if (this.grid) this.scene.remove(this.grid);
    this.grid = this.gridOf(dark ? "#262d36" : "#dbe1e8");
    this.scene.add(this.grid);
    this.select(this.selected);
  }

  gridOf(color) {
    const { low, high } = this.bounds();
    const points = [];
    const [x0, y0, x1, y1] = [low[0] - 1, low[1] - 1, high[0] + 1, high[1] + 1].map(Math.round);
    const pitch = Math.max(1, Math.ceil(Math.max(x1 - x0, y1 - y0) / 60));
    for (let x = x0; x <= x1; x += pitch) points.push(new THREE.Vector3(x, y0, 0), new THREE.Vector3(x, y1, 0));
    for (let y = y0; y <= y1; y += pitch) points.push(new THREE.Vector3(x0, y, 0), new THREE.Vector3(x1, y, 0));
    const grid = new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(points), new THREE.LineBasicMaterial({ color }));
    grid.position.z = this.floor - 0.01;
    return grid;
  }

  bounds() {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    const take = (at, reach) => at.forEach((value, axis) => { low[axis] = Math.min(low[axis], value - reach); high[axis] = Math.max(high[axis], value + reach); });
    for (const object of map.objects) take(object.position, Math.hypot(...object.semi_axes));
    for (const pose of run.way) take(pose.slice(1, 4), 0.2);
    return low[0] > high[0] ? { low: [-1, -1, 0], high: [1, 1, 1] } : { low, high };
  }

  /** Looks at all of the map from the side, or from above. */
  fit(fromAbove = false) {
    this.setFollow(false);
    const { low, high } = this.bounds();
    const middle = low.map((value, axis) => (value + high[axis]) / 2);
    const radius = Math.hypot(...low.map((value, axis) => high[axis] - value)) / 2;
    const across = Math.min(1, this.camera.aspect);
    const distance = (0.68 * radius) / Math.sin((this.camera.fov * Math.PI) / 360) / across;
    const direction = fromAbove ? [0, -0.0001, 1] : this.side(middle);
    const length = Math.hypot(...direction);
    this.controls.target.set(...middle);
    this.camera.position.set(...middle.map((value, axis) => value + (distance * direction[axis]) / length));
    this.controls.update();
    this.camera.updateMatrixWorld();
    this.invalidate();
  }

  /** From where the base was: what it saw has its front there. */
  side(middle) {
    const mean = (axis) => run.way.reduce((sum, pose) => sum + pose[1 + axis], 0) / Math.max(run.way.length, 1);
    const [x, y] = [0, 1].map((axis) => mean(axis) - this.objectMiddle(axis, middle[axis]));
    const length = Math.hypot(x, y);
    return length > 0.5 ? [(0.88 * x) / length, (0.88 * y) / length, 0.52] : [-0.62, -0.62, 0.52];
  }

  objectMiddle(axis, otherwise) {
    const all = map.objects.map((object) => object.position[axis]);
    return all.length ? all.reduce((sum, value) => sum + value, 0) / all.length : otherwise;
  }

  setFollow(follows) {
    if (follows === Boolean(this.follows)) return;
    this.follows = follows;
    this.controls.enabled = !follows;
    this.camera.up.set(0, 0, 1);
    if (follows) this.lookThrough(); else { this.camera.fov = 50; this.camera.updateProjectionMatrix(); }
    this.onFollow?.(follows);
  }

  lookThrough() {
    if (!this.pose) return;
    const at = (x, y, z) => new THREE.Vector3(x, y, z).applyMatrix4(this.pose.matrix);
    const eye = at(0, 0, 0);
    this.camera.up.copy(at(0, -1, 0).sub(eye));
    this.camera.position.copy(eye);
    this.camera.lookAt(at(0, 0, 1));
    this.camera.fov = this.pose.fov;
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }

  /** Turns the view (rad), brings it nearer by a factor. */
  turn(around, up, nearer = 1) {
    this.setFollow(false);
    const arm = this.camera.position.clone().sub(this.controls.target);
    const length = arm.length() / nearer;
    const heading = Math.atan2(arm.y, arm.x) + around;
    const height = Math.min(1.56, Math.max(-1.56, Math.asin(arm.z / arm.length()) + up));
    arm.set(length * Math.cos(height) * Math.cos(heading), length * Math.cos(height) * Math.sin(heading), length * Math.sin(height));
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
    this.camera.updateMatrixWorld();
    this.move();
  }

  /** Names beside objects, none over another one: of what is selected, of what the pointer is at, then of the nearest. */
  drawNames() {
    const pen = this.names.getContext("2d");
    const ratio = this.names.width / Math.max(this.canvas.clientWidth, 1);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, this.canvas.clientWidth, this.canvas.clientHeight);
    if (this.hidesNames) return;
    const style = getComputedStyle(document.documentElement);
    const [ink, back] = [style.getPropertyValue("--text"), style.getPropertyValue("--back")];
    const eye = this.camera.position;
    const far = (object) => {
      if (object.id === this.selected) return -2;
      if (object.id === this.pointed) return -1;
      const [x, y, z] = object.position;
      return Math.hypot(x - eye.x, y - eye.y, z - eye.z);
    };
    const taken = [];
    const sorted = this.objects.map((object) => [far(object), object]).sort((a, b) => a[0] - b[0]);
    pen.lineJoin = "round";
    for (const [, object] of sorted) {
      if (taken.length > (this.hurries ? 12 : this.objects.length > MANY ? 60 : 120)) break;
      const top = new THREE.Vector3(...object.position);
      top.z += object.semi_axes[2] + 0.03;
      top.project(this.camera);
      if (top.z > 1 || Math.abs(top.x) > 1 || Math.abs(top.y) > 1) continue;
      const is = object.id === this.selected;
      pen.font = `${is ? 650 : 500} 12px system-ui, sans-serif`;
      const text = nameOf(object).slice(0, 40);
      const width = pen.measureText(text).width;
      const [x, y] = [((top.x + 1) / 2) * this.canvas.clientWidth - width / 2, ((1 - top.y) / 2) * this.canvas.clientHeight];
      if (taken.some(([a, b, c]) => x < a + c + 4 && a < x + width + 4 && Math.abs(y - b) < 15)) continue;
      taken.push([x, y, width]);
      pen.strokeStyle = back;
      pen.lineWidth = 3.5;
      pen.strokeText(text, x, y);
      pen.fillStyle = ink;
      pen.fillText(text, x, y);
    }
  }
}
