// "Enter VR": the box is on a table in front of the person, enlarged for comfortable work. A controller is the shovel
// while its trigger or grip is pressed. The tool follows the controller's movement relative to its start, so that it
// does not jump. The controller vibrates with the force.

import type { Pose, Scene } from 'haptolith-protocol';
import {
  CircleGeometry,
  Color,
  CylinderGeometry,
  Group,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  Quaternion,
  Vector3,
} from 'three';
import type { Stage } from '../view/stage';
import { lookOf } from '../view/body_looks';
import type { Hand } from './hand';
import { fromThree, toThree } from './pose_math';

const TABLE_HEIGHT_M = 0.9;
const TABLE_AWAY_M = 0.55;
/** width of the box on the table: three times the 126 mm of icra2021 */
const BOX_ON_TABLE_M = 0.378;
const TABLE_WIDTHS = 1.15;
const PULSE_INTERVAL_MS = 40;
const FULL_PULSE_N = 4;

interface Grip {
  controller_m: Vector3;
  controller: Quaternion;
  tool: Pose;
}

interface ControllerEvent {
  data?: XRInputSource;
}

export class VrHand {
  /** reason why VR is not available, or null when it is */
  unavailable: string | null = 'looking for a headset';
  active = false;
  private grip: Grip | null = null;
  private source: XRInputSource | null = null;
  private pulsed_ms = 0;
  private readonly room = new Group();
  private readonly floor_material = new MeshBasicMaterial();
  private controllers_ready = false;

  constructor(
    private readonly stage: Stage,
    private readonly hand: Hand,
    private readonly force_n: () => number,
    private readonly onChange: () => void,
  ) {
    void this.look();
    const table = new Mesh(
      new CylinderGeometry(TABLE_WIDTHS * BOX_ON_TABLE_M, TABLE_WIDTHS * BOX_ON_TABLE_M * 0.94, 0.04, 64),
      new MeshStandardMaterial({ color: '#2b3238', roughness: 0.7 }),
    );
    table.position.set(0, TABLE_HEIGHT_M - 0.022, -TABLE_AWAY_M);
    const foot = new Mesh(
      new CylinderGeometry(0.05, 0.09, TABLE_HEIGHT_M - 0.04, 24),
      new MeshStandardMaterial({ color: '#232a30', roughness: 0.7 }),
    );
    foot.position.set(0, (TABLE_HEIGHT_M - 0.04) / 2, -TABLE_AWAY_M);
    const floor = new Mesh(new CircleGeometry(12, 48).rotateX(-Math.PI / 2), this.floor_material);
    this.room.add(table, foot, floor);
    this.room.visible = false;
    stage.world.add(this.room);
  }

  async toggle(): Promise<void> {
    const running = this.stage.renderer.xr.getSession();
    if (running) return running.end();
    const xr = this.stage.renderer.xr;
    const session = await navigator.xr!.requestSession('immersive-vr', { optionalFeatures: ['local-floor'] });
    this.prepareControllers();
    xr.enabled = true;
    xr.setReferenceSpaceType('local-floor');
    session.addEventListener('end', () => this.leave());
    try {
      await xr.setSession(session);
    } catch (error) {
      xr.enabled = false;
      void session.end();
      throw error;
    }
    this.enter();
  }

  setScene(scene: Scene): void {
    this.floor_material.color.copy(new Color(lookOf(scene.body).soil).multiplyScalar(0.16));
    if (this.active) this.placeBench(scene);
  }

  tick(now_ms: number): void {
    if (!this.active || !this.grip || !this.hand.isHeldBy('controller')) return;
    const controller = this.stage.renderer.xr.getController(this.controllerIndex());
    const bench = this.stage.bench;
    const scale = bench.scale.x;
    const bench_turn = bench.quaternion.clone().invert();
    const moved = controller.position
      .clone()
      .sub(this.grip.controller_m)
      .applyQuaternion(bench_turn)
      .divideScalar(scale);
    const turn = controller.quaternion.clone().multiply(this.grip.controller.clone().invert());
    const turn_in_scene = bench_turn.clone().multiply(turn).multiply(bench.quaternion);
    const start = new Vector3(...this.grip.tool.position_m).add(moved);
    this.hand.setPose({
      position_m: [start.x, start.y, start.z],
      rotation: fromThree(turn_in_scene.multiply(toThree(this.grip.tool.rotation)).normalize()),
    });
    this.pulse(now_ms);
  }

  private async look(): Promise<void> {
    if (!this.stage.draws) this.unavailable = 'this browser has no WebGL 2';
    else if (!navigator.xr)
      this.unavailable = 'this browser has no WebXR, or the page is not served from localhost or https';
    else {
      const supported = await navigator.xr.isSessionSupported('immersive-vr').catch(() => false);
      this.unavailable = supported ? null : 'no headset is connected';
    }
    this.onChange();
  }

  private enter(): void {
    this.active = true;
    this.room.visible = true;
    this.stage.setEdge(TABLE_WIDTHS);
    if (this.stage.currentScene) this.placeBench(this.stage.currentScene);
    this.onChange();
  }

  private leave(): void {
    this.release();
    this.active = false;
    this.room.visible = false;
    this.stage.renderer.xr.enabled = false;
    this.stage.setEdge(null);
    this.stage.bench.position.set(0, 0, 0);
    this.stage.bench.quaternion.identity();
    this.stage.bench.scale.setScalar(1);
    this.stage.refit();
    this.onChange();
  }

  private placeBench(scene: Scene): void {
    const scale = BOX_ON_TABLE_M / Math.max(scene.box.width_m, scene.box.length_m);
    const bench = this.stage.bench;
    bench.scale.setScalar(scale);
    // The scene's z axis is up; in the headset it is y.
    bench.rotation.set(-Math.PI / 2, 0, 0);
    bench.position.set(0, TABLE_HEIGHT_M, -TABLE_AWAY_M);
  }

  private prepareControllers(): void {
    if (this.controllers_ready) return;
    this.controllers_ready = true;
    for (const index of [0, 1]) {
      const controller = this.stage.renderer.xr.getController(index);
      const shell = new Mesh(
        new CylinderGeometry(0.012, 0.016, 0.1, 16).rotateX(Math.PI / 2),
        new MeshStandardMaterial({ color: '#39b8c6', roughness: 0.5, transparent: true, opacity: 0.6 }),
      );
      controller.add(shell);
      controller.addEventListener('connected', (event) => {
        controller.userData.source = (event as ControllerEvent).data;
      });
      controller.addEventListener('disconnected', () => {
        if (controller.userData.source === this.source) this.release();
        controller.userData.source = undefined;
      });
      for (const start of ['selectstart', 'squeezestart'] as const)
        controller.addEventListener(start, () => this.take(index));
      for (const end of ['selectend', 'squeezeend'] as const) controller.addEventListener(end, () => this.end(index));
      this.stage.world.add(controller);
    }
  }

  private controllerIndex(): number {
    return [0, 1].find((index) => this.sourceOf(index) === this.source) ?? 0;
  }

  private sourceOf(index: number): XRInputSource | undefined {
    return this.stage.renderer.xr.getController(index).userData.source as XRInputSource | undefined;
  }

  private take(index: number): void {
    const source = this.sourceOf(index);
    if (!source || this.grip) return;
    if (!this.hand.grab('controller')) return;
    const controller = this.stage.renderer.xr.getController(index);
    this.source = source;
    this.grip = {
      controller_m: controller.position.clone(),
      controller: controller.quaternion.clone(),
      tool: structuredClone(this.hand.wished),
    };
  }

  private end(index: number): void {
    if (this.sourceOf(index) === this.source) this.release();
  }

  private release(): void {
    this.grip = null;
    this.source = null;
    this.hand.release('controller');
  }

  private pulse(now_ms: number): void {
    const strength = Math.min(1, this.force_n() / FULL_PULSE_N);
    if (strength < 0.02 || now_ms - this.pulsed_ms < PULSE_INTERVAL_MS) return;
    this.pulsed_ms = now_ms;
    const actuator = this.source?.gamepad?.hapticActuators?.[0];
    void actuator?.pulse?.(strength, PULSE_INTERVAL_MS * 1.5);
  }
}
