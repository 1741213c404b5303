// Shadows of three.js (npm: three), its WebGLRenderer. See browser_shadows.py.
//
// The scene is one mesh for each kind of triangle; castShadow where it blocks, DoubleSide where its material is two-sided.
// Points are THREE.Points of ShadowMaterial, the material that shows nothing but shadows: its alpha is 1 minus the product
// of getShadow() of the lights, of which there is one at a time. Its shader is changed in two places: where a point is drawn
// (gl_Position, gl_PointSize), and the pixel by which PCF turns its samples, which is that of the scene's camera.
//
// Traps:
// - Of FrontSide materials the BACK faces are in the map (Material.shadowSide), so an open sheet lit from the front casts no
//   shadow; of DoubleSide ones both faces, which then shadow themselves where there is no bias. VSM takes material.side.
// - bias is in units of depth, negative away from acne; under lights with a place depth is not linear, so that its length
//   grows with the square of the distance over `near`. normalBias is a length, along the mesh's normal, not the visible side.
// - What lies outside of the shadow camera is lit. It is fitted to the scene's box; by default it is 10 wide, 0.5 to 500.
//   A spot light resets the field of view of its own camera to twice its angle.
// - VSM also draws what receives, though it casts no shadow; it has no point lights.
// - shadow.map of point lights is not resized with mapSize, and shadowMap.type is read only where a map is made.
// - autoUpdate renders the map again for each picture: it is off, and needsUpdate asks for it once.
// - Objects are culled by their own bounding sphere: the points would be, as they are not where they are drawn.
import * as THREE from 'three';
import {finish, serve} from './browser_page.js';

const TYPES = {basic: THREE.BasicShadowMap, pcf: THREE.PCFShadowMap, vsm: THREE.VSMShadowMap};
const SIDES = {material: null, front: THREE.FrontSide, back: THREE.BackSide, double: THREE.DoubleSide};
const HELLO = {
  name: 'three.js', takes: 'points', lights: ['directional', 'point', 'spot'],
  summary: 'Shadow maps of its WebGLRenderer, read through its ShadowMaterial at each point.',
  parameters: [
    {name: 'type', type: 'choice', choices: 'basic|pcf|vsm', default: 'pcf', phase: 'aim', sweep: 'basic|pcf|vsm',
     doc: 'shadowMap.type: one look-up; 5 filtered look-ups; variance (not of point lights)'},
    {name: 'size', type: 'integer', default: 512, min: 64, max: 8192, phase: 'aim', sweep: '512|1024|2048|4096',
     doc: 'side of the map, of each of six faces under a point light'},
    {name: 'bias', type: 'real', default: 0, min: -0.1, max: 0.1, phase: 'visibility', sweep: '0|-0.0005|-0.005',
     doc: 'added to the depth of a point, in units of the depth buffer'},
    {name: 'normal_bias', type: 'real', default: 0.05, min: 0, max: 10, phase: 'visibility', sweep: '0|0.02|0.05|0.1',
     doc: 'moves a point along its normal, in units of the scene; the library has 0, which shadows all lit surfaces by themselves'},
    {name: 'radius', type: 'real', default: 1, min: 0, max: 32, phase: 'aim',
     doc: 'of the blur, in texels of the map: of the look-ups of pcf, of the pass over the map of vsm'},
    {name: 'blur_samples', type: 'integer', default: 8, min: 1, max: 64, phase: 'aim', doc: 'of the blur of vsm'},
    {name: 'shadow_side', type: 'choice', choices: 'material|front|back|double', default: 'material', phase: 'aim',
     doc: 'faces in the map; material: both of a two-sided material, else the back faces'}],
};

function make() {
  const renderer = new THREE.WebGLRenderer(), gl = renderer.getContext(), scene = new THREE.Scene();
  renderer.shadowMap.enabled = true;
  renderer.shadowMap.autoUpdate = false;
  const camera = new THREE.PerspectiveCamera();
  const material = new THREE.ShadowMaterial({blending: THREE.NoBlending, depthTest: false, depthWrite: false});
  material.onBeforeCompile = shader => {
    shader.vertexShader = 'attribute vec4 place;\nvarying vec2 vPixel;\n' + shader.vertexShader.replace(
        '#include <fog_vertex>', 'gl_Position = vec4(place.xy, 0.0, 1.0);\ngl_PointSize = 1.0;\nvPixel = place.zw;');
    shader.fragmentShader = 'varying vec2 vPixel;\n' + shader.fragmentShader.replace(
        '#include <shadowmap_pars_fragment>', THREE.ShaderChunk.shadowmap_pars_fragment.replaceAll('gl_FragCoord.xy', 'vPixel'));
  };
  const dots = new THREE.Points(new THREE.BufferGeometry(), material);
  dots.frustumCulled = false;
  dots.receiveShadow = true;
  scene.add(dots);
  const target = new THREE.WebGLRenderTarget(1, 1, {
    type: THREE.FloatType, minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter, depthBuffer: false});
  let meshes = [], count = 0, light = null, made = '', warm = {};

  function lightOf(of, size, type) {  // a map is made once for its kind, size and type
    const key = [of.type, size, type].join();
    if (key === made) return;
    if (light) {
      scene.remove(light, light.target);
      light.shadow.map?.depthTexture?.dispose();
      light.dispose();
    }
    light = {directional: () => new THREE.DirectionalLight(), point: () => new THREE.PointLight(),
             spot: () => new THREE.SpotLight()}[of.type]();
    light.castShadow = true;
    light.shadow.mapSize.set(size, size);
    light.shadow.camera.layers.set(1);
    scene.add(light);
    if (light.target) scene.add(light.target);
    made = key;
    warm = {aim: false, look: false};
  }

  function aimAt(of, fit) {
    const shadow = light.shadow, eye = shadow.camera;
    if (of.type === 'directional') {
      light.target.position.fromArray(fit.centre);
      light.position.fromArray(fit.centre).addScaledVector(new THREE.Vector3(...of.direction), -2 * fit.radius);
      scene.updateMatrixWorld();
      shadow.updateMatrices(light);  // for the view
      const box = new THREE.Box3(new THREE.Vector3(...fit.min), new THREE.Vector3(...fit.max));
      const {min, max} = box.applyMatrix4(eye.matrixWorldInverse), margin = 1e-3 * fit.radius;
      Object.assign(eye, {left: min.x - margin, right: max.x + margin, bottom: min.y - margin, top: max.y + margin,
                          near: -max.z - margin, far: -min.z + margin});
    } else {
      light.position.fromArray(of.position);
      Object.assign(eye, {near: fit.near, far: fit.far});
      if (of.type === 'spot') {
        light.angle = THREE.MathUtils.degToRad(of.cutoff);
        light.target.position.fromArray(of.position).add(new THREE.Vector3(...of.direction));
      }
    }
    eye.updateProjectionMatrix();
  }

  return {
    hello: HELLO,
    build(groups) {
      for (const mesh of meshes) {
        scene.remove(mesh);
        mesh.geometry.dispose();
        mesh.material.dispose();
      }
      meshes = groups.map(group => {
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute('position', new THREE.BufferAttribute(group.positions, 3));
        geometry.setAttribute('normal', new THREE.BufferAttribute(group.normals, 3));
        const side = group.twoSided ? THREE.DoubleSide : THREE.FrontSide;
        const mesh = new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({side}));
        mesh.castShadow = group.blocks;
        mesh.receiveShadow = true;
        mesh.layers.set(1);  // of the shadow's camera alone
        scene.add(mesh);
        return mesh;
      });
    },
    points(p) {
      const places = new Float32Array(4 * p.count);
      for (let i = 0; i < p.count; ++i)
        places.set([p.places[2 * i], p.places[2 * i + 1], p.pixels[2 * i], p.pixels[2 * i + 1]], 4 * i);
      dots.geometry.dispose();
      dots.geometry = new THREE.BufferGeometry();
      dots.geometry.setAttribute('position', new THREE.BufferAttribute(p.positions, 3));
      dots.geometry.setAttribute('normal', new THREE.BufferAttribute(p.normals, 3));
      dots.geometry.setAttribute('place', new THREE.BufferAttribute(places, 4));
      target.setSize(p.width, p.height);
      count = p.count;
    },
    aim(of, settings, fit) {
      const {type = 'pcf', size = 512, radius = 1, blur_samples: blurSamples = 8, shadow_side: side = 'material'} = settings;
      if (type === 'vsm' && of.type === 'point') throw new Error('vsm has no point lights');
      renderer.shadowMap.type = TYPES[type];
      lightOf(of, size, type);
      aimAt(of, fit);
      Object.assign(light.shadow, {radius, blurSamples});
      for (const mesh of meshes) mesh.material.shadowSide = SIDES[side];
      dots.visible = false;
      const draw = () => {
        const begin = performance.now();
        renderer.shadowMap.needsUpdate = true;
        renderer.setRenderTarget(null);
        renderer.render(scene, camera);
        finish(gl);
        return performance.now() - begin;
      };
      if (!warm.aim) draw();
      warm.aim = true;
      return draw();
    },
    visibility({bias = 0, normal_bias: normalBias = 0.05}) {
      Object.assign(light.shadow, {bias, normalBias});
      dots.visible = true;
      const rgba = new Float32Array(4 * target.width * target.height), s = new Float32Array(count);
      const draw = () => {
        const begin = performance.now();
        renderer.setRenderTarget(target);
        renderer.render(scene, camera);
        renderer.readRenderTargetPixels(target, 0, 0, target.width, target.height, rgba);
        return performance.now() - begin;
      };
      if (!warm.look) draw();
      warm.look = true;
      const ms = draw();
      for (let i = 0; i < count; ++i) s[i] = 1 - rgba[4 * i + 3];
      return {ms, s};
    },
  };
}

serve(make);
