// Bodies, joints and traces as three.js draws them.

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  DynamicDrawUsage,
  InstancedMesh,
  Line,
  LineBasicMaterial,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  SphereGeometry,
} from "three";
import { between, decode } from "./decode.js";

const INK = "#333333";
const LARGEST = 32767; // of whole numbers of two bytes

/** What is drawn of a page; `show(s)` moves all of it to state s. */
export function drawn(page) {
  const parts = page.bodies.map((body) => surface(body, page));
  if (page.joints) parts.push(balls(page.joints, page));
  return {
    objects: [...parts.map((part) => part.object), ...page.traces.map(trace)],
    show: (s) => parts.forEach((part) => part.show(s)),
  };
}

/** A body: each corner goes with a ring, at an offset along some of the ring's directors. */
function surface(body, page) {
  const [x, d] = [decode(body.places), decode(body.directors)];
  const [ring, offset] = [decode(body.ring), decode(body.offset)];
  const directors = offset.length / ring.length;
  const rings = new Float32Array(3 * body.rings);
  const axes = new Float32Array(3 * body.rings * directors);
  const places = new Float32Array(3 * ring.length);
  const geometry = new BufferGeometry();
  const position = new BufferAttribute(places, 3).setUsage(DynamicDrawUsage);
  geometry.setAttribute("position", position);
  geometry.setIndex(new BufferAttribute(decode(body.triangles), 1));
  const material = new MeshLambertMaterial({ color: body.colour, side: DoubleSide });
  const paint = body.values ? painter(body, ring, page.colours, geometry, material) : () => {};
  const mesh = new Mesh(geometry, material);
  mesh.frustumCulled = false; // where it is changes
  return {
    object: mesh,
    show(s) {
      between(x, rings.length, s, page.unit, rings);
      between(d, axes.length, s, 1 / LARGEST, axes);
      for (let c = 0; c < ring.length; c++) {
        for (let i = 0; i < 3; i++) {
          let sum = rings[3 * ring[c] + i];
          for (let k = 0; k < directors; k++) {
            sum += offset[directors * c + k] * axes[3 * (directors * ring[c] + k) + i];
          }
          places[3 * c + i] = sum;
        }
      }
      position.needsUpdate = true;
      geometry.computeVertexNormals();
      paint(s);
    },
  };
}

/** Colours of corners by the values of their rings in a state. */
function painter(body, ring, scale, geometry, material) {
  const series = decode(body.values);
  const values = new Float32Array(body.rings);
  const colours = new Float32Array(3 * ring.length);
  const attribute = new BufferAttribute(colours, 3).setUsage(DynamicDrawUsage);
  const shades = scale.names.map((name) => new Color(name).toArray());
  geometry.setAttribute("color", attribute);
  material.vertexColors = true;
  material.color.set("white");
  return (s) => {
    between(series, values.length, s, 1, values);
    ring.forEach((one, c) => colours.set(shades[Math.round(values[one])], 3 * c));
    attribute.needsUpdate = true;
  };
}

function balls(joints, page) {
  const series = decode(joints.places);
  const places = new Float32Array(3 * joints.count);
  const ball = new SphereGeometry(joints.radius, 12, 8);
  const object = new InstancedMesh(ball, new MeshLambertMaterial({ color: INK }), joints.count);
  object.frustumCulled = false;
  const at = new Matrix4();
  return {
    object,
    show(s) {
      between(series, places.length, s, page.unit, places);
      for (let i = 0; i < joints.count; i++) {
        at.makeTranslation(places[3 * i], places[3 * i + 1], places[3 * i + 2]);
        object.setMatrixAt(i, at);
      }
      object.instanceMatrix.needsUpdate = true;
    },
  };
}

function trace(packed) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(decode(packed), 3));
  return new Line(geometry, new LineBasicMaterial({ color: INK }));
}
