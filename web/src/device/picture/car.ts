/** A plain car and the device in it. Metres, vehicle frame: x forward, y left, z up. */
import {
  ArrowHelper,
  BoxGeometry,
  type BufferGeometry,
  CanvasTexture,
  CylinderGeometry,
  EdgesGeometry,
  ExtrudeGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshStandardMaterial,
  type Object3D,
  Shape,
  Sprite,
  SpriteMaterial,
  SRGBColorSpace,
  Vector2,
  Vector3,
} from "three";
import { t } from "../../text";

export interface Palette {
  car: string;
  line: string;
  tyre: string;
  ink: string;
  box: string;
  axes: readonly [string, string, string];
}

type Profile = readonly (readonly [number, number])[];

/** Outlines in the plane of x and z. */
// biome-ignore format: one outline a line
const BODY: Profile = [[-2.05, 0.36], [-2.1, 0.7], [-1.95, 0.86], [0.95, 0.86], [1.9, 0.74], [2.05, 0.56], [2.05, 0.36]];
const CABIN: Profile = [
  [-1.8, 0.9],
  [-1.35, 1.36],
  [0.05, 1.38],
  [0.9, 0.9],
];
const WIDTH = { body: 1.5, cabin: 1.26 };
const BEVEL = 0.12;
const WHEEL = { radius: 0.33, width: 0.22, front: 1.3, rear: -1.25, side: 0.8 };

/** The device stands where dashboards are, drawn several times larger than it is. */
const DEVICE_AT = new Vector3(0.45, 0, 1.05);
const DEVICE_SIZE = [0.74, 0.5, 0.24] as const;
const AXIS_LENGTH = 1.2;
const HEAD = [0.26, 0.15] as const;

/** What a picture shows: some of it stands still, the rest is turned. */
export interface Content {
  still: Object3D[];
  turned: Object3D;
}

/** The device, turned in its car by q_vs. */
export function mountedDevice(palette: Palette): Content {
  return { still: [makeCar(palette), makeDirections(palette)], turned: makeDevice(palette) };
}

/** The car, tilted on level ground. */
export function tiltedCar(palette: Palette): Content {
  return { still: [makeDirections(palette)], turned: makeCar(palette) };
}

/** See-through, so that the device in it is seen from everywhere. */
export function makeCar(palette: Palette): Group {
  const car = new Group();
  const skin = (opacity: number) =>
    new MeshStandardMaterial({
      color: palette.car,
      transparent: true,
      opacity,
      depthWrite: false,
      roughness: 0.9,
    });
  car.add(
    new Mesh(extruded(BODY, WIDTH.body), skin(0.5)),
    new Mesh(extruded(CABIN, WIDTH.cabin), skin(0.28)),
  );
  for (const x of [WHEEL.front, WHEEL.rear])
    car.add(wheel(x, WHEEL.side, palette), wheel(x, -WHEEL.side, palette));
  return car;
}

/** An outline drawn out along y. */
function extruded(profile: Profile, width: number): BufferGeometry {
  const shape = new Shape(profile.map(([x, z]) => new Vector2(x, z)));
  const bevel = { bevelThickness: BEVEL, bevelSize: BEVEL / 2, bevelSegments: 5 };
  return new ExtrudeGeometry(shape, { depth: width, ...bevel })
    .rotateX(Math.PI / 2)
    .translate(0, width / 2, 0);
}

function edges(geometry: BufferGeometry, color: string): LineSegments {
  return new LineSegments(new EdgesGeometry(geometry, 20), new LineBasicMaterial({ color }));
}

function wheel(x: number, y: number, palette: Palette): Mesh {
  const tyre = new CylinderGeometry(WHEEL.radius, WHEEL.radius, WHEEL.width, 32);
  const mesh = new Mesh(tyre, new MeshStandardMaterial({ color: palette.tyre, roughness: 1 }));
  mesh.position.set(x, y, WHEEL.radius);
  return mesh;
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
    device.add(
      label("xyz"[i] ?? "", color, direction.clone().multiplyScalar(AXIS_LENGTH + 0.22), LABEL.axis),
    );
  });
  device.position.copy(DEVICE_AT);
  device.traverse(drawLast);
  return device;
}

/** After the car's see-through skin, which would veil it. */
function drawLast(part: Object3D): void {
  if (!(part instanceof Mesh || part instanceof LineSegments)) return;
  part.renderOrder = 1;
  part.material.transparent = true;
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
    group.add(
      label(name, palette.ink, from.clone().addScaledVector(direction, length + 0.35), LABEL.direction),
    );
  };
  add(t("device.picture.forward"), new Vector3(2.4, 0, 0), new Vector3(1, 0, 0), 0.8);
  add(t("device.picture.leftward"), new Vector3(0, 1.1, 0), new Vector3(0, 1, 0), 0.7);
  return group;
}

/** CSS pixels; large enough for a phone in the sun, whatever the size of the picture. */
const LABEL = { axis: 19, direction: 15 };
const LETTERING = "600 46px system-ui, sans-serif";

/** Text that always faces the reader. */
function label(text: string, color: string, position: Vector3, pixels: number): Sprite {
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("2d");
  canvas.height = 64;
  if (context) {
    context.font = LETTERING;
    canvas.width = Math.max(64, Math.ceil(context.measureText(text).width) + 8);
    context.font = LETTERING;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = color;
    context.fillText(text, canvas.width / 2, 32);
  }
  const map = new CanvasTexture(canvas);
  map.colorSpace = SRGBColorSpace;
  const sprite = new Sprite(
    new SpriteMaterial({ map, depthTest: false, transparent: true, sizeAttenuation: false }),
  );
  sprite.position.copy(position);
  sprite.userData.size = [(pixels * canvas.width) / canvas.height, pixels];
  sprite.renderOrder = 2;
  return sprite;
}

/** Keep all labels at their size when the picture changes its own; `pixel`: what a CSS pixel is at the distance 1. */
export function sizeLabels(scene: Object3D, pixel: number): void {
  scene.traverse((part) => {
    if (!(part instanceof Sprite)) return;
    const [width, height] = part.userData.size as [number, number];
    part.scale.set(width * pixel, height * pixel, 1);
  });
}
