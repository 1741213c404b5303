// Shadows of Babylon.js (npm: babylonjs), its ShadowGenerator. See browser_shadows.py.
//
// Points are a mesh that is drawn as a point cloud with StandardMaterial, which receives shadows. A plugin of the material
// (MaterialPluginBase) says where each point is drawn, and writes the variable `shadow` of its shader in place of the colour.
// Of the scene, only what blocks is there: it casts. Its materials cull back faces unless they are two-sided.
//
// Traps:
// - There is no shadow without a ShadowGenerator, and no default size of its map; 1024 is that of its documentation.
// - Depths are half floats unless its third argument asks for floats: with 11 bits surfaces shadow themselves. `pcf` and
//   `pcss` compare with the depth buffer instead.
// - Under point lights `pcf` and `pcss` silently become `poisson`, and the blurred filters the unblurred ones.
// - bias is in units of the map's depth range, and moves the caster; normalBias too, scaled by the sine at the light.
// - A directional light fits its map to the boxes of what casts, with a tenth of margin on each side, but its depth only
//   with autoCalcShadowZBounds; other lights take near and far from the camera that looks (1 to 10000): here from `fit`.
// - The angle of a spot light is the full one. Outside of its map all is lit, beyond its far end with some filters, too.
// - Shaders compile while pictures without them are drawn: the page waits until all are ready.
// - The map is rendered with each picture of the scene: here its refreshRate is once, and it is asked for.
import {finish, serve} from './browser_page.js';
import 'babylonjs';

const B = globalThis.BABYLON;
const FILTERS = {
  none: 'NONE', poisson: 'POISSONSAMPLING', esm: 'EXPONENTIALSHADOWMAP', blur_esm: 'BLUREXPONENTIALSHADOWMAP',
  close_esm: 'CLOSEEXPONENTIALSHADOWMAP', blur_close_esm: 'BLURCLOSEEXPONENTIALSHADOWMAP', pcf: 'PCF', pcss: 'PCSS'};
const HELLO = {
  name: 'Babylon.js', takes: 'points', lights: ['directional', 'point', 'spot'],
  summary: 'Shadow maps of its ShadowGenerator, read through its StandardMaterial at each point.',
  parameters: [
    {name: 'filter', type: 'choice', choices: Object.keys(FILTERS).join('|'), default: 'none', phase: 'aim',
     sweep: 'none|poisson|pcf|close_esm', doc: 'the filter of the look-up; pcf and pcss are poisson under a point light'},
    {name: 'size', type: 'integer', default: 1024, min: 64, max: 8192, phase: 'aim', sweep: '512|1024|2048|4096',
     doc: 'side of the map, of each of six faces under a point light'},
    {name: 'bias', type: 'real', default: 0.00005, min: 0, max: 0.1, phase: 'aim', sweep: '0.00005|0.0005|0.005',
     doc: "added to the map's depths, of its range from near to far"},
    {name: 'normal_bias', type: 'real', default: 0.02, min: 0, max: 10, phase: 'aim', sweep: '0|0.02|0.05|0.1',
     doc: 'moves what casts against its normal where light grazes it, in units of the scene'},
    {name: 'quality', type: 'choice', choices: 'low|medium|high', default: 'high', phase: 'aim',
     doc: 'of pcf: 1, 9, 25 texels; of pcss: 16, 32, 64 look-ups'},
    {name: 'float32', type: 'boolean', default: false, phase: 'aim', doc: 'depths are floats, not half floats'},
    {name: 'back_faces_only', type: 'boolean', default: false, phase: 'aim', doc: 'forceBackFacesOnly'},
  ],
};

class ShadowFactor extends B.MaterialPluginBase {
  constructor(material) {
    super(material, 'ShadowFactor', 200, {}, true, true);
  }
  getClassName() {
    return 'ShadowFactor';
  }
  getAttributes(attributes) {
    attributes.push('place');
  }
  getCustomCode(shader) {
    return shader === 'vertex' ? {
      CUSTOM_VERTEX_DEFINITIONS: 'attribute vec2 place;',
      CUSTOM_VERTEX_MAIN_END: 'gl_Position = vec4(place, 0.0, 1.0); gl_PointSize = 1.0;'
    } : {CUSTOM_FRAGMENT_MAIN_END: 'gl_FragColor = vec4(shadow);'};
  }
}

async function make() {
  const canvas = document.createElement('canvas');
  const engine = new B.Engine(canvas, false), gl = canvas.getContext('webgl2'), scene = new B.Scene(engine);
  scene.useRightHandedSystem = true;
  scene.activeCamera = new B.TargetCamera('camera', B.Vector3.Zero(), scene);
  const material = new B.StandardMaterial('points', scene);
  material.pointsCloud = true;
  new ShadowFactor(material);
  let casters = [], dots = null, target = null, count = 0, light = null, generator = null, made = '', warm = {};

  function mesh(name, data, of) {
    const made = new B.Mesh(name, scene), vertices = new B.VertexData();
    vertices.positions = data.positions;
    vertices.normals = data.normals;
    vertices.indices = Uint32Array.from({length: data.positions.length / 3}, (_, k) => k);
    vertices.applyToMesh(made);
    made.material = of;
    return made;
  }

  async function ready() {
    const until = performance.now() + 60000;
    const all = () => casters.every(c => c.subMeshes.every(m => generator.isReady(m, false, false))) && (!dots || dots.isReady(true));
    while (!all()) {
      if (performance.now() > until) throw new Error('its shaders are not ready');
      await new Promise(done => setTimeout(done, 2));
    }
  }

  return {
    hello: HELLO,
    build(groups) {
      for (const caster of casters) caster.dispose(false, true);
      casters = groups.filter(group => group.blocks).map(group => {
        const of = new B.StandardMaterial('caster', scene);
        of.backFaceCulling = !group.twoSided;
        return mesh('caster', group, of);
      });
    },
    points(p) {
      dots?.dispose();
      target?.dispose();
      dots = mesh('points', p, material);
      dots.setVerticesData('place', p.places, false, 2);
      dots.receiveShadows = dots.alwaysSelectAsActiveMesh = true;
      target = new B.RenderTargetTexture('S', {width: p.width, height: p.height}, scene, {
        type: B.Constants.TEXTURETYPE_FLOAT, samplingMode: B.Constants.TEXTURE_NEAREST_SAMPLINGMODE, generateMipMaps: false});
      target.renderList = [dots];
      count = p.count;
    },
    async aim(of, settings, fit) {
      const {filter = 'none', size = 1024, quality = 'high', bias = 0.00005, normal_bias: normalBias = 0.02,
             float32 = false} = settings;
      const at = new B.Vector3(...of.position ?? [0, 0, 0]), along = new B.Vector3(...of.direction ?? [0, -1, 0]);
      const key = [of.type, filter, size, quality, float32].join();
      if (key !== made) {  // a map is made once for its settings
        generator?.dispose();
        light?.dispose();
        light = of.type === 'directional' ? new B.DirectionalLight('light', along, scene) :
                of.type === 'point' ? new B.PointLight('light', at, scene) : new B.SpotLight('light', at, along, 1, 1, scene);
        generator = new B.ShadowGenerator(size, light, float32);
        generator.filter = B.ShadowGenerator['FILTER_' + FILTERS[filter]];
        generator.filteringQuality = B.ShadowGenerator['QUALITY_' + quality.toUpperCase()];
        made = key;
        warm = {aim: false, look: false};
      }
      if (of.type === 'directional')
        Object.assign(light, {autoCalcShadowZBounds: true, position: new B.Vector3(...fit.centre).subtract(along.scale(2 * fit.radius))});
      else
        Object.assign(light, {position: at, shadowMinZ: fit.near, shadowMaxZ: fit.far});
      if (of.type !== 'point') light.direction = along;
      if (of.type === 'spot') light.angle = of.cutoff * Math.PI / 90;
      light.forceProjectionMatrixCompute();
      Object.assign(generator, {bias, normalBias, forceBackFacesOnly: settings.back_faces_only ?? false});
      const map = generator.getShadowMap();
      map.refreshRate = B.RenderTargetTexture.REFRESHRATE_RENDER_ONCE;
      map.renderList = [...casters];
      await ready();
      const draw = () => {
        const begin = performance.now();
        map.render();
        finish(gl);
        return performance.now() - begin;
      };
      if (!warm.aim) draw();
      warm.aim = true;
      return draw();
    },
    async visibility() {
      await ready();
      const draw = async () => {
        const begin = performance.now();
        target.render();
        const rgba = await target.readPixels();
        return {rgba, ms: performance.now() - begin};
      };
      if (!warm.look) await draw();
      warm.look = true;
      const {rgba, ms} = await draw(), s = new Float32Array(count);
      for (let i = 0; i < count; ++i) s[i] = rgba[4 * i];
      return {ms, s};
    },
  };
}

serve(make);
