"use strict";
// Objects as they are outlined: solids and wires of unit half extents, drawn once for all objects of a kind.

/** Pieces of a curve: fewer where there are many objects. */
const MANY = 300;
let curve = 40;
const finer = (few, many) => (curve < 40 ? many : few);
const expectObjects = (count) => { curve = count > MANY ? 14 : 40; };

/** A superquadric's surface at angles of the profile and the footprint (Barr 1981). */
function superPoint([e1, e2], profile, round) {
  const power = (value, exponent) => Math.sign(value) * Math.abs(value) ** exponent;
  const ring = power(Math.cos(profile), e1);
  return [ring * power(Math.cos(round), e2), ring * power(Math.sin(round), e2), power(Math.sin(profile), e1)];
}

function solidOf(outline) {
  const { kind, exponents } = outlineOf(outline);
  if (kind === "cuboid") return new THREE.BoxGeometry(2, 2, 2);
  if (kind === "cylinder") return new THREE.CylinderGeometry(1, 1, 2, finer(28, 10)).rotateX(Math.PI / 2);
  if (kind === "ellipsoid") return new THREE.SphereGeometry(1, finer(24, 10), finer(16, 6)).rotateX(Math.PI / 2);
  const sphere = new THREE.SphereGeometry(1, finer(32, 12), finer(24, 8)).rotateX(Math.PI / 2);
  const at = sphere.attributes.position;
  for (let i = 0; i < at.count; i += 1) {
    const profile = Math.asin(Math.min(1, Math.max(-1, at.getZ(i))));
    at.setXYZ(i, ...superPoint(exponents, profile, Math.atan2(at.getY(i), at.getX(i))));
  }
  sphere.computeVertexNormals();
  return sphere;
}

function wireOf(outline) {
  const { kind, exponents } = outlineOf(outline);
  const points = [];
  const round = (at) => {
    for (let i = 0; i < curve; i += 1) points.push(...at((2 * Math.PI * i) / curve), ...at((2 * Math.PI * (i + 1)) / curve));
  };
  if (kind === "cuboid") {
    for (const a of [-1, 1]) for (const b of [-1, 1]) points.push(a, b, -1, a, b, 1, a, -1, b, a, 1, b, -1, a, b, 1, a, b);
  } else if (kind === "cylinder") {
    for (const z of [-1, 1]) round((angle) => [Math.cos(angle), Math.sin(angle), z]);
    for (const [x, y] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) points.push(x, y, -1, x, y, 1);
  } else {
    const e = exponents || [1, 1];
    round((angle) => superPoint(e, 0, angle));
    round((angle) => superPoint(e, angle, Math.abs(angle - Math.PI) < Math.PI / 2 ? Math.PI : 0).map((v, i) => (i === 1 ? 0 : v)));
    round((angle) => { const [x, , z] = superPoint(e, angle, 0); return [0, x, z]; });
  }
  return new Float32Array(points);
}

const WIRE_SHADER = {
  vertexShader: `attribute mat4 place; attribute vec3 tint; varying vec3 color;
    void main() { color = tint; gl_Position = projectionMatrix * modelViewMatrix * place * vec4(position, 1.0); }`,
  fragmentShader: `uniform float opacity; varying vec3 color;
    void main() { gl_FragColor = vec4(color, opacity); }`,
};

/** Many wires of one form, each with its place and colour. */
class Wires {
  constructor(points, most, opacity = 1) {
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
    this.place = new THREE.InstancedBufferAttribute(new Float32Array(16 * most), 16);
    this.tint = new THREE.InstancedBufferAttribute(new Float32Array(3 * most), 3);
    geometry.setAttribute("place", this.place);
    geometry.setAttribute("tint", this.tint);
    geometry.instanceCount = 0;
    const material = new THREE.ShaderMaterial({ ...WIRE_SHADER, uniforms: { opacity: { value: opacity } }, transparent: opacity < 1 });
    this.drawn = new THREE.LineSegments(geometry, material);
    this.drawn.frustumCulled = false;
  }

  set(places, tints) {
    this.drawn.geometry.instanceCount = places.length;
    places.forEach((matrix, i) => { matrix.toArray(this.place.array, 16 * i); this.tint.array.set(tints[i], 3 * i); });
    this.place.needsUpdate = true;
    this.tint.needsUpdate = true;
  }
}

/** Many solids of one form. */
class Solids {
  constructor(geometry, most, opacity) {
    const material = new THREE.MeshLambertMaterial({ transparent: true, opacity, depthWrite: false });
    this.drawn = new THREE.InstancedMesh(geometry, material, Math.max(most, 1));
    this.drawn.count = 0;
    this.drawn.frustumCulled = false;
  }

  set(places, tints) {
    this.drawn.count = places.length;
    const color = new THREE.Color();
    places.forEach((matrix, i) => { this.drawn.setMatrixAt(i, matrix); this.drawn.setColorAt(i, color.setRGB(...tints[i])); });
    this.drawn.instanceMatrix.needsUpdate = true;
    if (this.drawn.instanceColor) this.drawn.instanceColor.needsUpdate = true;
  }
}

const placeOf = ({ position, orientation, semi_axes: half }) => new THREE.Matrix4().compose(
  new THREE.Vector3(...position), new THREE.Quaternion(...orientation), new THREE.Vector3(...half),
);

/** Red, green, blue of a colour in letters, as they are mixed with light. */
const tintOf = (() => {
  const known = new Map();
  return (hex) => {
    if (!known.has(hex)) known.set(hex, new THREE.Color(hex).toArray());
    return known.get(hex);
  };
})();
/** The same for wires, which light does not change: as they are on the screen. */
const inkOf = (() => {
  const known = new Map();
  return (hex) => {
    if (!known.has(hex)) {
      const bits = parseInt(hex.slice(1), 16);
      known.set(hex, [(bits >> 16) / 255, ((bits >> 8) & 255) / 255, (bits & 255) / 255]);
    }
    return known.get(hex);
  };
})();

/** Where a ray enters an object's box, or nothing. */
function entry(ray, object) {
  const back = new THREE.Matrix4().compose(
    new THREE.Vector3(...object.position), new THREE.Quaternion(...object.orientation), new THREE.Vector3(1, 1, 1),
  ).invert();
  const from = ray.origin.clone().applyMatrix4(back).toArray();
  const along = ray.direction.clone().transformDirection(back).toArray();
  let near = 0;
  let far = Infinity;
  for (let axis = 0; axis < 3; axis += 1) {
    const half = object.semi_axes[axis];
    const [a, b] = [(-half - from[axis]) / along[axis], (half - from[axis]) / along[axis]];
    near = Math.max(near, Math.min(a, b));
    far = Math.min(far, Math.max(a, b));
  }
  return near <= far ? near : null;
}
