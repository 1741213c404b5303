// What the pages of threejs.js and babylonjs.js share: the loop over messages, the files, and what is computed of them.
//
// A library is an object with
//   hello                          its answer to hello, without the version
//   build(groups)                  of meshes: positions, normals (flat, as there are none in a scene), blocks, twoSided
//   points(p)                      positions, normals (of the winding, as a mesh has them), count, width x height pixels,
//                                  places (x, y of each point's own pixel in -1..1), pixels (its pixel in the scene's camera)
//   aim(light, settings, fit)      renders the shadow map; returns ms
//   visibility(settings)           returns {ms, s}: the shadow factor of each point
//
// No library has a sensible shadow camera by default; `fit` is what tutorials do by hand: box (min, max, centre, radius)
// of the scene, and near and far of a light at a place. Times are of the map and of the look-up alone: without the fit, and
// after a first picture that is not timed where a map is new, for then shaders are compiled.
//
// Outside of a spot's cone the answer is undefined: its map ends there. The cone is at most 80 degrees (half).

const WIDEST = 80;

async function npy(name) {
  const bytes = await (await fetch('data/' + name)).arrayBuffer();
  const view = new DataView(bytes);
  const begin = view.getUint8(6) === 1 ? 10 + view.getUint16(8, true) : 12 + view.getUint32(8, true);
  return bytes.slice(begin);
}

async function write(name, s) {
  const text = `{'descr': '<f4', 'fortran_order': False, 'shape': (${s.length},), }`;
  const head = String.fromCharCode(0x93) + 'NUMPY\x01\x00\x76\x00' + text.padEnd(117) + '\n';
  await fetch('data/' + name, {method: 'POST', body: new Blob([Uint8Array.from(head, c => c.charCodeAt(0)), s])});
}

const sub = (a, b) => a.map((x, k) => x - b[k]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => a.map(x => x / Math.hypot(...a));

export class Scene {
  constructor(native, corners, objects, blocks) {
    Object.assign(this, {native, corners, blocks});
    this.count = blocks.length;
    const sides = native.objects.map(o => native.materials?.[o.material]?.two_sided ?? true);
    this.twoSided = Array.from(objects, k => sides[k]);
    this.normals = new Float32Array(corners.length);
    for (let t = 0; t < this.count; ++t) {
      const [a, b, c] = this.triangle(t);
      const n = cross(sub(b, a), sub(c, a)), length = Math.hypot(...n) || 1;
      for (let k = 0; k < 9; ++k) this.normals[9 * t + k] = n[k % 3] / length;
    }
    const min = [Infinity, Infinity, Infinity], max = [-Infinity, -Infinity, -Infinity];
    corners.forEach((x, k) => { min[k % 3] = Math.min(min[k % 3], x); max[k % 3] = Math.max(max[k % 3], x); });
    this.box = this.count ? {min, max} : {min: [-1, -1, -1], max: [1, 1, 1]};
    this.box.centre = this.box.min.map((x, k) => (x + this.box.max[k]) / 2);
    this.box.radius = Math.hypot(...sub(this.box.max, this.box.centre)) || 1;
  }

  triangle(t) {
    return [0, 3, 6].map(k => Array.from(this.corners.subarray(9 * t + k, 9 * t + k + 3)));
  }

  groups() {
    const groups = [];
    for (const blocks of [true, false])
      for (const twoSided of [true, false]) {
        const which = [];
        for (let t = 0; t < this.count; ++t) if (!!this.blocks[t] === blocks && this.twoSided[t] === twoSided) which.push(t);
        const positions = new Float32Array(9 * which.length), normals = new Float32Array(9 * which.length);
        which.forEach((t, k) => {
          positions.set(this.corners.subarray(9 * t, 9 * t + 9), 9 * k);
          normals.set(this.normals.subarray(9 * t, 9 * t + 9), 9 * k);
        });
        if (which.length) groups.push({positions, normals, blocks, twoSided});
      }
    return groups;
  }

  // No blocker is nearer to a place than this: the distances to a triangle's plane and to its box are at most that to it.
  nearest(at) {
    let least = Infinity;
    for (let t = 0; t < this.count; ++t) {
      if (!this.blocks[t]) continue;
      const corners = this.triangle(t), n = Array.from(this.normals.subarray(9 * t, 9 * t + 3));
      const beside = [0, 1, 2].map(k => {
        const x = corners.map(c => c[k]);
        return Math.max(Math.min(...x) - at[k], at[k] - Math.max(...x), 0);
      });
      least = Math.min(least, Math.max(Math.abs(dot(n, sub(at, corners[0]))), Math.hypot(...beside)));
    }
    return least;
  }

  // Of a light at a place whose map reaches to this tangent of the angle from its axis: depth is along the axis.
  fit(at, tangent) {
    const {min, max} = this.box;
    const far = 1.001 * Math.hypot(...[0, 1, 2].map(k => Math.max(Math.abs(at[k] - min[k]), Math.abs(at[k] - max[k]))));
    const near = 0.99 * this.nearest(at) / Math.sqrt(1 + 2 * tangent * tangent);
    return {far, near: Math.min(Math.max(near, 1e-4 * far), 0.5 * far)};
  }

  // The pixel of a picture of the scene's own size in which a place is seen, for noise that depends on the pixel.
  pixel(at) {
    const {eye, target, up = [0, 1, 0], fov = 45, height} = this.native.camera, [w, h] = this.native.size ?? [640, 360];
    const forward = unit(sub(target, eye)), d = sub(at, eye);
    let right = cross(forward, up);
    if (Math.hypot(...right) < 1e-9) right = cross(forward, Math.abs(forward[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]);
    right = unit(right);
    const full = height ?? 2 * Math.tan(fov * Math.PI / 360) * dot(d, forward);
    return [w / 2 + h * dot(d, right) / full, h / 2 + h * dot(d, cross(right, forward)) / full]
        .map(x => Number.isFinite(x) ? Math.floor(x) + 0.5 : 0.5);
  }

  points(bytes) {
    const record = 56, view = new DataView(bytes), count = bytes.byteLength / record;
    const width = Math.min(1024, Math.max(1, count)), height = Math.max(1, Math.ceil(count / width));
    const p = {count, width, height, positions: new Float32Array(3 * count), normals: new Float32Array(3 * count),
               places: new Float32Array(2 * count), pixels: new Float32Array(2 * count)};
    for (let i = 0; i < count; ++i) {
      const at = [0, 8, 16].map(k => view.getFloat64(record * i + k, true));
      const t = view.getUint32(record * i + 36, true);
      if (t < this.count) {
        p.positions.set(at, 3 * i);
        p.normals.set(this.normals.subarray(9 * t, 9 * t + 3), 3 * i);
        p.pixels.set(this.pixel(at), 2 * i);
      }
      p.places.set([(2 * (i % width) + 1) / width - 1, (2 * Math.floor(i / width) + 1) / height - 1], 2 * i);
    }
    return p;
  }
}

async function answer(m, library, now) {
  if (m.message === 'hello') return library.hello;
  if (m.message === 'scene') {
    const native = await (await fetch('data/' + m.scene)).json();
    now.scene = new Scene(native, new Float32Array(await npy(m.triangles)), new Uint32Array(await npy(m.objects)),
                          new Uint8Array(await npy(m.blocks)));
    return {};
  }
  const begin = performance.now();
  if (m.message === 'build') await library.build(now.scene.groups());
  if (m.message === 'points') {
    now.points = now.scene.points(await npy(m.points));
    await library.points(now.points);
  }
  if (m.message === 'aim') {
    const light = {...m.description};
    if (light.type === 'spot') light.cutoff = Math.min(light.cutoff ?? 45, WIDEST);
    const tangent = light.type === 'spot' ? Math.tan(light.cutoff * Math.PI / 180) : 1;
    if (light.direction) light.direction = unit(light.direction);
    now.light = light;
    return {ms: await library.aim(light, m.settings, {...now.scene.box, ...light.position && now.scene.fit(light.position, tangent)})};
  }
  if (m.message === 'visibility') {
    const asked = new Uint8Array(await npy(m.asked)), {ms, s} = await library.visibility(m.settings), {light, points} = now;
    for (let i = 0; i < points.count; ++i) {
      if (!asked[i]) s[i] = NaN;
      else if (light.type === 'spot') {
        const d = sub(Array.from(points.positions.subarray(3 * i, 3 * i + 3)), light.position);
        if (dot(d, light.direction) < Math.cos(light.cutoff * Math.PI / 180) * Math.hypot(...d)) s[i] = NaN;
      }
    }
    await write(m.answers, s);
    return {ms};
  }
  return {ms: performance.now() - begin};
}

/// Answers messages for ever; the first answer, without a message, is that to hello.
export async function serve(make) {
  const reply = of => fetch('answer', {method: 'POST', body: JSON.stringify(of)});
  addEventListener('unhandledrejection', e => reply({error: String(e.reason)}));
  const now = {};
  let library;
  try {
    library = await make();
    await reply(library.hello);
  } catch (e) {
    await reply({error: String(e)});
  }
  for (;;) {
    const m = await (await fetch('next')).json();
    let of;
    try {
      of = await answer(m, library, now);
    } catch (e) {
      of = {error: e.message ?? String(e)};
    }
    await reply(of);
  }
}

/// Waits until the GPU is done: a pixel that is read comes after all that was asked before.
export function finish(gl) {
  gl.finish();
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
}
