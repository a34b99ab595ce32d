/** A plain car and the device in it. Metres, vehicle frame: x forward, y left, z up. */
import {
  ArrowHelper,
  BoxGeometry,
  type BufferGeometry,
  CanvasTexture,
  CylinderGeometry,
  DoubleSide,
  EdgesGeometry,
  ExtrudeGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshStandardMaterial,
  Shape,
  Sprite,
  SpriteMaterial,
  SRGBColorSpace,
  Vector3,
} from "three";

export interface Palette {
  car: string;
  edge: string;
  ink: string;
  box: string;
  axes: readonly [string, string, string];
}

type Profile = readonly (readonly [number, number])[];
const BODY: Profile = [
  [-2.15, 0.28], [-2.2, 0.75], [-2.05, 0.95], [-1.55, 1.4], [0.15, 1.45], [0.95, 0.95], [2.0, 0.82], [2.2, 0.6], [2.2, 0.28],
]; // biome-ignore format: one outline
const WIDTH = 1.75;
const WHEELS = [[1.35, 0.78], [1.35, -0.78], [-1.3, 0.78], [-1.3, -0.78]] as const; // biome-ignore format: pairs

/** The device stands where dashboards are, drawn several times larger than it is. */
const DEVICE_AT = new Vector3(0.35, 0, 0.95);
const DEVICE_SIZE = [0.62, 0.42, 0.2] as const;
const AXIS_LENGTH = 1.25;
const HEAD = [0.24, 0.13] as const;

export function makeCar(palette: Palette): Group {
  const car = new Group();
  const body = extruded(BODY);
  const skin = { color: palette.car, transparent: true, opacity: 0.32, depthWrite: false, side: DoubleSide };
  car.add(new Mesh(body, new MeshStandardMaterial(skin)), edges(body, palette.edge));
  for (const [x, y] of WHEELS) car.add(wheel(x, y, palette));
  return car;
}

/** The outline lies in the plane of x and z; it is drawn out along y. */
function extruded(profile: Profile): BufferGeometry {
  const shape = new Shape(profile.map(([x, z]) => new Vector3(x, z, 0) as never));
  return new ExtrudeGeometry(shape, { depth: WIDTH, bevelEnabled: false })
    .rotateX(Math.PI / 2)
    .translate(0, WIDTH / 2, 0);
}

function edges(geometry: BufferGeometry, color: string): LineSegments {
  return new LineSegments(new EdgesGeometry(geometry, 20), new LineBasicMaterial({ color }));
}

function wheel(x: number, y: number, palette: Palette): Group {
  const group = new Group();
  const tyre = new CylinderGeometry(0.33, 0.33, 0.2, 28);
  group.add(new Mesh(tyre, new MeshStandardMaterial({ color: palette.edge })), edges(tyre, palette.ink));
  group.position.set(x, y, 0.33);
  return group;
}

/** The device with its axes; its quaternion is q_vs. */
export function makeDevice(palette: Palette): Group {
  const device = new Group();
  const box = new BoxGeometry(...DEVICE_SIZE);
  device.add(
    new Mesh(box, new MeshStandardMaterial({ color: palette.box, roughness: 0.6 })),
    edges(box, palette.ink),
  );
  const directions = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];
  directions.forEach((direction, i) => {
    const color = palette.axes[i] ?? palette.ink;
    device.add(new ArrowHelper(direction, new Vector3(), AXIS_LENGTH, color, ...HEAD));
    device.add(shaft(direction, color));
    device.add(label("xyz"[i] ?? "", color, direction.clone().multiplyScalar(AXIS_LENGTH + 0.22), 0.34));
  });
  device.position.copy(DEVICE_AT);
  return device;
}

/** Lines are one pixel wide on every screen; a thin rod is seen in sunlight. */
function shaft(direction: Vector3, color: string): Mesh {
  const length = AXIS_LENGTH - HEAD[0];
  const rod = new Mesh(
    new CylinderGeometry(0.028, 0.028, length, 12),
    new MeshStandardMaterial({ color, roughness: 0.8 }),
  );
  rod.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), direction);
  rod.position.copy(direction).multiplyScalar(length / 2);
  return rod;
}

/** The vehicle's own directions, on the ground beside it. */
export function makeDirections(palette: Palette): Group {
  const group = new Group();
  const add = (name: string, from: Vector3, direction: Vector3, length: number) => {
    group.add(new ArrowHelper(direction, from, length, palette.ink, 0.22, 0.14));
    group.add(label(name, palette.ink, from.clone().addScaledVector(direction, length + 0.35), 0.3));
  };
  add("forward", new Vector3(2.4, 0, 0), new Vector3(1, 0, 0), 0.8);
  add("left", new Vector3(0, 1.1, 0), new Vector3(0, 1, 0), 0.7);
  return group;
}

/** Text that always faces the reader. */
function label(text: string, color: string, position: Vector3, height: number): Sprite {
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("2d");
  canvas.height = 64;
  canvas.width = Math.max(64, 34 * text.length);
  if (context) {
    context.font = "600 46px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = color;
    context.fillText(text, canvas.width / 2, 32);
  }
  const map = new CanvasTexture(canvas);
  map.colorSpace = SRGBColorSpace;
  const sprite = new Sprite(new SpriteMaterial({ map, depthTest: false, transparent: true }));
  sprite.position.copy(position);
  sprite.scale.set((height * canvas.width) / canvas.height, height, 1);
  sprite.renderOrder = 1;
  return sprite;
}
