// Soil wrench as arrows at the tool: a straight one for the force, one around its axis for the torque. Also the spring
// that pulls the tool to its target. Drawn over everything, because soil must not hide them. Their length depends on
// the picture, not on the box, so that they are always legible. They are thin compared with the tool, which they must
// not hide.

import type { Frame, Scene, Vec3 } from 'haptolith-protocol';
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
import { shapeOf } from '../tool_shapes';

export const FORCE_COLOUR = '#ff5a5f';
export const TORQUE_COLOUR = '#ffb02e';
const SPRING_COLOUR = '#7fd7e6';

// Smaller values are noise.
const LEAST_FORCE_N = 0.01;
const LEAST_TORQUE_NM = 0.0005;

// Length of 1 N, as a fraction of the shorter side of the picture.
const NEWTON_LENGTH = 0.065;
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
  private picture_m = 0.2;
  private tool_m = 0.05;
  private most_nm = 0.2;
  private force_n: Vec3 = [0, 0, 0];

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
    this.group.visible = false; // nothing is known before the first frame
  }

  setScene(scene: Scene): void {
    this.tool_m = shapeOf(scene.tool).longest_m(scene.tool);
    this.most_nm = scene.hand.max_torque_nm;
    this.showSizes();
  }

  /** Sets the length at the bed, in m, of the picture's shorter side. */
  setPicture(picture_m: number): void {
    if (Math.abs(picture_m - this.picture_m) < 0.002 * this.picture_m) return;
    this.picture_m = picture_m;
    this.showSizes();
  }

  setFrame(frame: Frame, held: boolean): void {
    this.group.visible = true;
    this.group.position.set(...frame.tool.position_m);
    this.force_n = frame.force_n;
    this.showForce();
    this.showTorque(frame.torque_nm);
    this.showSpring(frame, held);
  }

  private get ring_m(): number {
    return Math.max(0.42 * this.tool_m, 0.04 * this.picture_m);
  }

  private showSizes(): void {
    this.torque.scale.setScalar(this.ring_m);
    this.showForce();
  }

  private showForce(): void {
    const vector = new Vector3(...this.force_n);
    const newtons = vector.length();
    this.force.visible = newtons >= LEAST_FORCE_N;
    if (!this.force.visible) return;
    // The arrow saturates at 6 N; the number next to the view shows larger forces.
    const length_m = Math.min(newtons, 6) * NEWTON_LENGTH * this.picture_m;
    const thick_m = Math.max(Math.min(0.012 * this.picture_m, 0.05 * this.tool_m), 0.0035 * this.picture_m);
    const drawn_m = thick_m * Math.min(1, length_m / (0.1 * this.picture_m));
    const tip_m = Math.min(0.45 * length_m, 5 * drawn_m);
    this.force.quaternion.copy(new Quaternion().setFromUnitVectors(Z, vector.normalize()));
    this.shaft.scale.set(drawn_m * 0.55, drawn_m * 0.55, length_m - tip_m);
    this.tip.position.z = length_m - tip_m;
    this.tip.scale.set(drawn_m * 1.6, drawn_m * 1.6, tip_m);
  }

  private showTorque(torque_nm: Vec3): void {
    const vector = new Vector3(...torque_nm);
    const newton_metres = vector.length();
    this.torque.visible = newton_metres >= LEAST_TORQUE_NM;
    if (!this.torque.visible) return;
    // The square root keeps small torques visible: a tenth of the maximum turns a third of the full angle.
    const turn = LARGEST_TURN * Math.sqrt(Math.min(1, newton_metres / this.most_nm));
    if (Math.abs(turn - this.ring_turn) > 0.03) {
      this.ring.geometry.dispose();
      this.ring.geometry = new TorusGeometry(1, 0.05, 8, 48, turn);
      this.ring_turn = turn;
    }
    this.ring_tip.position.set(Math.cos(turn), Math.sin(turn), 0);
    this.ring_tip.rotation.z = turn;
    // If the arc is shorter than its tip, the tip is smaller.
    this.ring_tip.scale.setScalar(Math.min(1, turn / 0.7));
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
    const coil_m = Math.min(0.05 * this.ring_m + 0.06 * length_m, 0.1 * this.ring_m);
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
