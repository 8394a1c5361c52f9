// What the hand feels, as arrows at the tool: the force straight, the torque around its axis. And the spring that pulls
// the tool to where the hand wants it. Drawn over everything: an arrow that soil hides says nothing.

import {
  BufferGeometry,
  ConeGeometry,
  CylinderGeometry,
  DynamicDrawUsage,
  Float32BufferAttribute,
  Group,
  Line,
  LineBasicMaterial,
  Mesh,
  MeshBasicMaterial,
  Quaternion,
  TorusGeometry,
  Vector3,
} from 'three';
import type { Frame, Scene, Vec3 } from '../protocol';

export const FORCE_COLOUR = '#ff5a5f';
export const TORQUE_COLOUR = '#ffb02e';
const SPRING_COLOUR = '#7fd7e6';

// Below these an arrow is noise.
const LEAST_FORCE_N = 0.01;
const LEAST_TORQUE_NM = 0.0005;

const LARGEST_TURN = 1.75 * Math.PI;
const SPRING_POINTS = 96;

const Z = new Vector3(0, 0, 1);

export class ArrowsView {
  readonly group = new Group();
  private readonly force = new Group();
  private readonly shaft: Mesh;
  private readonly tip: Mesh;
  private readonly torque = new Group();
  private ring: Mesh<TorusGeometry, MeshBasicMaterial>;
  private readonly ring_tip: Mesh;
  private readonly spring: Line<BufferGeometry, LineBasicMaterial>;
  private ring_turn = 0;
  private unit_m = 0.02;
  private size_m = 0.02;
  private most_nm = 0.2;

  constructor() {
    const force_material = overlay(FORCE_COLOUR);
    const torque_material = overlay(TORQUE_COLOUR);
    this.shaft = new Mesh(new CylinderGeometry(1, 1, 1, 16).rotateX(Math.PI / 2).translate(0, 0, 0.5), force_material);
    this.tip = new Mesh(new ConeGeometry(1, 1, 20).rotateX(Math.PI / 2).translate(0, 0, 0.5), force_material);
    this.force.add(this.shaft, this.tip);
    this.ring = new Mesh(new TorusGeometry(1, 0.05, 8, 48, 1), torque_material);
    this.ring_tip = new Mesh(new ConeGeometry(0.16, 0.36, 16), torque_material);
    this.torque.add(this.ring, this.ring_tip);
    this.spring = new Line(
      new BufferGeometry().setAttribute(
        'position',
        new Float32BufferAttribute(new Float32Array(SPRING_POINTS * 3), 3).setUsage(DynamicDrawUsage),
      ),
      new LineBasicMaterial({ color: SPRING_COLOUR, transparent: true, depthTest: false }),
    );
    this.spring.frustumCulled = false;
    for (const [i, object] of [this.spring, this.ring, this.ring_tip, this.shaft, this.tip].entries())
      object.renderOrder = 21 + i;
    this.group.add(this.force, this.torque, this.spring);
  }

  /** Length of 1 N in mm, for the legend. */
  get millimetresPerNewton(): number {
    return this.unit_m * 1000;
  }

  setScene(scene: Scene): void {
    const width_m = Math.max(scene.box.width_m, scene.box.length_m);
    // 1 N is as long as a sixth of the box, so that a scoop's two or three newtons fill half of it.
    this.unit_m = Math.max(0.001, Math.round((width_m * 1000) / 6 / 5) * 0.005);
    this.size_m = 0.012 + 0.02 * width_m;
    const [x, y] = scene.tool.size_mm;
    const tool_m = (scene.tool.shape === 'box' ? Math.max(x, y) : scene.tool.diameter_mm) / 1000;
    this.size_m = Math.max(0.42 * tool_m, 0.03 * width_m);
    this.most_nm = scene.hand.max_torque_nm;
  }

  setFrame(frame: Frame, held: boolean): void {
    this.group.position.set(...frame.tool.position_m);
    this.showForce(frame.force_n);
    this.showTorque(frame.torque_nm);
    this.showSpring(frame, held);
  }

  private showForce(force_n: Vec3): void {
    const vector = new Vector3(...force_n);
    const newtons = vector.length();
    this.force.visible = newtons >= LEAST_FORCE_N;
    if (!this.force.visible) return;
    // Six newtons are the longest that is drawn; beyond, the number beside the view tells.
    const length_m = Math.min(newtons, 6) * this.unit_m;
    const thick_m = 0.0035 * Math.min(1, length_m / 0.02) * (this.unit_m / 0.02) ** 0.6 * 0.7;
    const tip_m = Math.min(0.45 * length_m, 5 * thick_m);
    this.force.quaternion.copy(new Quaternion().setFromUnitVectors(Z, vector.normalize()));
    this.shaft.scale.set(thick_m * 0.55, thick_m * 0.55, length_m - tip_m);
    this.tip.position.z = length_m - tip_m;
    this.tip.scale.set(thick_m * 1.6, thick_m * 1.6, tip_m);
  }

  private showTorque(torque_nm: Vec3): void {
    const vector = new Vector3(...torque_nm);
    const newton_metres = vector.length();
    this.torque.visible = newton_metres >= LEAST_TORQUE_NM;
    if (!this.torque.visible) return;
    // The square root keeps small torques visible: a tenth of the largest turns a third of the way.
    const turn = LARGEST_TURN * Math.sqrt(Math.min(1, newton_metres / this.most_nm));
    if (Math.abs(turn - this.ring_turn) > 0.03) {
      this.ring.geometry.dispose();
      this.ring.geometry = new TorusGeometry(1, 0.05, 8, 48, turn);
      this.ring_turn = turn;
    }
    this.ring_tip.position.set(Math.cos(turn), Math.sin(turn), 0);
    this.ring_tip.rotation.z = turn;
    this.torque.scale.setScalar(this.size_m);
    this.torque.quaternion.setFromUnitVectors(Z, vector.normalize());
  }

  private showSpring(frame: Frame, held: boolean): void {
    const way = new Vector3(...frame.wished.position_m).sub(new Vector3(...frame.tool.position_m));
    const length_m = way.length();
    this.spring.visible = held && length_m > 0.0005;
    if (!this.spring.visible) return;
    const across = Math.abs(way.z) > 0.9 * length_m ? new Vector3(1, 0, 0) : Z;
    const side = new Vector3().crossVectors(way, across).normalize();
    const other = new Vector3().crossVectors(way, side).normalize();
    const position = this.spring.geometry.getAttribute('position');
    const coil_m = Math.min(0.05 * this.size_m + 0.06 * length_m, 0.1 * this.size_m);
    for (let i = 0; i < SPRING_POINTS; ++i) {
      const share = i / (SPRING_POINTS - 1);
      // Straight at both ends, eight coils between them.
      const wide = coil_m * Math.min(1, 8 * Math.min(share, 1 - share));
      const angle = 16 * Math.PI * share;
      const c = wide * Math.cos(angle);
      const s = wide * Math.sin(angle);
      position.setXYZ(
        i,
        way.x * share + side.x * c + other.x * s,
        way.y * share + side.y * c + other.y * s,
        way.z * share + side.z * c + other.z * s,
      );
    }
    position.needsUpdate = true;
    const newtons = Math.hypot(...frame.force_n);
    this.spring.material.color.set(SPRING_COLOUR).lerp(SPRING_HOT, Math.min(1, newtons / 3));
  }
}

const SPRING_HOT = new MeshBasicMaterial({ color: FORCE_COLOUR }).color;

function overlay(color: string): MeshBasicMaterial {
  return new MeshBasicMaterial({ color, depthTest: false, transparent: true, opacity: 0.92 });
}
