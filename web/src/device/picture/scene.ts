/** The 3D picture. It draws only when something changes: a phone's battery is not for a picture that stands still. */
import {
  DirectionalLight,
  GridHelper,
  HemisphereLight,
  Matrix4,
  PerspectiveCamera,
  Quaternion,
  Scene,
  Spherical,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { DEGREES, type Quaternion as Rotation } from "../../lib/rotation";
import { type Content, type Palette, sizeLabels } from "./car";

export type ViewName = "corner" | "above" | "left" | "behind";

/** Where the camera stands from its target, metres. Straight above is taken a little off: there "up" is not unique. */
const CAMERAS: Record<ViewName, Vector3> = {
  corner: new Vector3(-4.7, 3.8, 2.9),
  above: new Vector3(-0.01, 0, 7.4),
  left: new Vector3(0, 7.2, 0.15),
  behind: new Vector3(-7.4, 0, 0.8),
};
const TARGET = new Vector3(0.2, 0, 0.85);
/** Camera's angle from straight above, rad: hardly below the ground. */
const LOWEST = Math.PI * 0.52;
/** Spherical coordinates know y as up. */
const Y_UP = new Matrix4().makeRotationX(-Math.PI / 2);
const Z_UP = new Matrix4().makeRotationX(Math.PI / 2);
/** ms */
const TURN = 500;

export class CarScene {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(38, 1, 0.1, 60);
  private readonly controls: OrbitControls;
  private readonly turned;
  private readonly watcher: ResizeObserver;
  private frame = 0;

  /** Throws where the browser has no WebGL. */
  constructor(
    private readonly host: HTMLElement,
    palette: Palette,
    makeContent: (palette: Palette) => Content,
    private readonly still: boolean,
    /** somebody turned the picture: it shows none of the views any more */
    private readonly onOrbit: () => void,
  ) {
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    const content = makeContent(palette);
    this.turned = content.turned;
    this.fill(palette, content);
    this.camera.up.set(0, 0, 1);
    this.controls = this.makeControls();
    host.append(this.renderer.domElement);
    this.watcher = new ResizeObserver(() => this.resize());
    this.watcher.observe(host);
    this.look("corner");
  }

  private fill(palette: Palette, { still, turned }: Content): void {
    const sun = new DirectionalLight("#ffffff", 1.6);
    sun.position.set(-3, 4, 8);
    const grid = new GridHelper(12, 12, palette.line, palette.line).rotateX(Math.PI / 2);
    grid.material.transparent = true;
    grid.material.opacity = 0.6;
    const light = new HemisphereLight("#ffffff", "#8899aa", 1.6);
    this.scene.add(light, sun, grid, ...still, turned);
  }

  private makeControls(): OrbitControls {
    const controls = new OrbitControls(this.camera, this.renderer.domElement);
    controls.target.copy(TARGET);
    controls.enablePan = false;
    controls.enableZoom = false;
    controls.maxPolarAngle = LOWEST;
    controls.addEventListener("change", () => this.render());
    controls.addEventListener("start", this.onOrbit);
    // One finger sideways turns the car, up and down scrolls the page.
    this.renderer.domElement.style.touchAction = "pan-y";
    return controls;
  }

  /** Turn what is turned in the picture, at once or in half a second. */
  turn([w, x, y, z]: Rotation, animated: boolean): void {
    cancelAnimationFrame(this.frame);
    const from = this.turned.quaternion.clone();
    const to = new Quaternion(x, y, z, w);
    if (!animated || this.still) {
      this.turned.quaternion.copy(to);
      this.render();
      return;
    }
    const start = performance.now();
    const step = (now: number) => {
      const share = Math.min((now - start) / TURN, 1);
      this.turned.quaternion.slerpQuaternions(from, to, share * (2 - share));
      this.render();
      if (share < 1) this.frame = requestAnimationFrame(step);
    };
    this.frame = requestAnimationFrame(step);
  }

  look(view: ViewName): void {
    this.camera.position.copy(TARGET).add(CAMERAS[view]);
    this.controls.update();
    this.render();
  }

  /** Turn the camera about the vehicle, degrees to its left and up, as far as the controls let it. */
  orbit(left: number, up: number): void {
    const seen = new Spherical().setFromVector3(this.camera.position.clone().sub(TARGET).applyMatrix4(Y_UP));
    seen.theta += left / DEGREES;
    seen.phi = Math.min(Math.max(seen.phi - up / DEGREES, 0.01), LOWEST);
    this.camera.position.setFromSpherical(seen).applyMatrix4(Z_UP).add(TARGET);
    this.controls.update();
    this.render();
    this.onOrbit();
  }

  dispose(): void {
    cancelAnimationFrame(this.frame);
    this.watcher.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.renderer.domElement.remove();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.host;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight);
    this.camera.aspect = clientWidth / clientHeight;
    // A narrow picture needs a wider angle to hold the whole car.
    this.camera.fov = this.camera.aspect > 1.5 ? 36 : 44;
    this.camera.updateProjectionMatrix();
    sizeLabels(this.scene, (2 * Math.tan(this.camera.fov / DEGREES / 2)) / clientHeight);
    this.render();
  }

  private render(): void {
    this.renderer.render(this.scene, this.camera);
  }
}
