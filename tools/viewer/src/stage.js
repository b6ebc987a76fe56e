// What is around the bodies: light, camera, axes with round numbers.

import {
  BufferAttribute,
  BufferGeometry,
  DirectionalLight,
  HemisphereLight,
  LineBasicMaterial,
  LineSegments,
  OrthographicCamera,
  Scene,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { CSS2DObject, CSS2DRenderer } from "three/examples/jsm/renderers/CSS2DRenderer.js";

const GRID = "#cccccc";
const MARGIN = 1.22; // of what is seen, for the numbers at the axes
const REST = 200; // ms without a new picture, after which what stands is drawn finely

/** A stage in an element of the page, for a box of ticks along x, y and z. */
export function stage(element, axes) {
  const slow = byProcessor();
  const renderer = new WebGLRenderer({ antialias: !slow, preserveDrawingBuffer: true });
  renderer.setPixelRatio(window.devicePixelRatio);
  renderer.setClearColor("white");
  const labels = new CSS2DRenderer();
  labels.domElement.className = "labels";
  element.append(renderer.domElement, labels.domElement);

  const scene = new Scene();
  const { low, high } = ends(axes);
  const middle = low.clone().add(high).multiplyScalar(0.5);
  const radius = 0.5 * low.distanceTo(high);
  const camera = new OrthographicCamera();
  camera.up.set(0, 0, 1);
  camera.position.copy(middle).addScaledVector(view(axes), 4 * radius);
  camera.near = 0;
  camera.far = 8 * radius;
  const light = new DirectionalLight("white", 1.6);
  light.position.set(0.4, 0.6, 1);
  camera.add(light);
  scene.add(new HemisphereLight("white", "#999999", 1.6), camera, ...grid(axes, low, high));

  const controls = new OrbitControls(camera, renderer.domElement);
  controls.target.copy(middle);

  const render = () => renderer.render(scene, camera);
  const draw = slow ? coarseThenFine(renderer, render) : render;
  function turned() {
    draw();
    labels.render(scene, camera);
  }
  function fit() {
    const { clientWidth: width, clientHeight: height } = element;
    if (!width || !height) return;
    renderer.setSize(width, height);
    labels.setSize(width, height);
    const half = Math.max(reach.y, (reach.x * height) / width);
    camera.top = half;
    camera.bottom = -half;
    camera.right = (half * width) / height;
    camera.left = -camera.right;
    camera.updateProjectionMatrix();
    turned();
  }
  controls.update();
  const reach = seen(camera, low, high);
  controls.addEventListener("change", turned);
  new ResizeObserver(fit).observe(element);
  fit();
  return { scene, draw };
}

/** Whether there is no graphics card: smooth edges would cost as much as all else. */
function byProcessor() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const told = gl?.getExtension("WEBGL_debug_renderer_info");
  return /swiftshader|llvmpipe|software/i.test(told ? gl.getParameter(told.UNMASKED_RENDERER_WEBGL) : "");
}

/** Pictures that move have the pixels of the screen, one that stands twice as many each way. */
function coarseThenFine(renderer, render) {
  let waiting = 0;
  let fine = false;
  const drawn = (times) => {
    if (fine !== times > 1) renderer.setPixelRatio(times * window.devicePixelRatio);
    fine = times > 1;
    render();
  };
  return () => {
    clearTimeout(waiting);
    waiting = setTimeout(() => drawn(2), REST);
    drawn(1);
  };
}

/** How far a box reaches to the side and up, from the middle of what the camera sees. */
function seen(camera, low, high) {
  camera.updateMatrixWorld();
  const reach = new Vector3();
  for (let corner = 0; corner < 8; corner++) {
    const [x, y, z] = [0, 1, 2].map((i) => ((corner >> i) & 1 ? high : low).getComponent(i));
    const at = new Vector3(x, y, z).applyMatrix4(camera.matrixWorldInverse);
    reach.max(new Vector3(Math.abs(at.x), Math.abs(at.y), 0));
  }
  return reach.multiplyScalar(MARGIN);
}

function ends(axes) {
  const of = (pick) => new Vector3(...axes.map((axis) => pick(axis.ticks)));
  return { low: of((ticks) => ticks[0]), high: of((ticks) => ticks[ticks.length - 1]) };
}

/** From where one looks: against the axis along which nothing extends, or from aside. */
function view(axes) {
  const flat = axes.map((axis) => axis.flat);
  if (flat.filter(Boolean).length !== 1) return new Vector3(1, -1.4, 0.8).normalize();
  return [new Vector3(1, 0, 0), new Vector3(0, -1, 0), new Vector3(0, -1e-6, 1)][flat.indexOf(true)];
}

/** Lines through the ticks on three sides of the box, and numbers at three edges. */
function grid(axes, low, high) {
  const places = [];
  const labels = [];
  const extent = low.distanceTo(high);
  axes.forEach((axis, i) => {
    const [j, k] = [(i + 1) % 3, (i + 2) % 3];
    for (const tick of axis.ticks) {
      for (const [along, across] of [[j, k], [k, j]]) {
        const a = wall(low, high).setComponent(i, tick);
        a.setComponent(along, low.getComponent(along));
        const b = a.clone().setComponent(along, high.getComponent(along));
        a.setComponent(across, wall(low, high).getComponent(across));
        b.setComponent(across, wall(low, high).getComponent(across));
        places.push(...a.toArray(), ...b.toArray());
      }
    }
    labels.push(...numbers(axis, i, low, high, 0.04 * extent));
  });
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(places), 3));
  return [new LineSegments(geometry, new LineBasicMaterial({ color: GRID })), ...labels];
}

/** The corner of the box behind what is seen at first. */
const wall = (low, high) => new Vector3(low.x, high.y, low.z);

function numbers(axis, i, low, high, gap) {
  if (axis.flat) return [];
  const edge = new Vector3(high.x, low.y, low.z);
  if (i === 2) edge.set(high.x, high.y, low.z);
  const away = [new Vector3(0, -gap, -gap / 2), new Vector3(gap, 0, -gap / 2), new Vector3(gap, 0, 0)];
  const at = (value, text, far) => {
    const label = new CSS2DObject(document.createElement("span"));
    label.element.textContent = text;
    label.position.copy(edge).setComponent(i, value).addScaledVector(away[i], far);
    return label;
  };
  const { ticks } = axis;
  const middle = (ticks[0] + ticks[ticks.length - 1]) / 2;
  return [...ticks.map((tick, n) => at(tick, axis.texts[n], 1)), at(middle, axis.label, 2.6)];
}
