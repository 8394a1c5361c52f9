// Last reported tool pose of a remote robot: an outline that glides from one report to the next.

import { isSameTool, type Robot, type Tool } from 'haptolith-protocol';
import {
  BufferGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  Quaternion,
  Vector3,
} from 'three';
import { shapeOf } from '../tool_shapes';

const COLOUR = '#ff9f43';
// Reports come four times a second.
const GLIDE_MS = 250;

export class RobotView {
  readonly group = new Group();
  private built_for: Tool | null = null;
  private readonly lines = new LineBasicMaterial({ color: COLOUR, transparent: true, opacity: 0.9, depthTest: false });
  private readonly fill = new MeshBasicMaterial({
    color: COLOUR,
    transparent: true,
    opacity: 0.12,
    depthWrite: false,
    depthTest: false,
  });
  private readonly from = { at: new Vector3(), turn: new Quaternion() };
  private readonly to = { at: new Vector3(), turn: new Quaternion() };
  private since_ms = -Infinity;
  private heard_of = false;

  constructor() {
    this.group.visible = false;
  }

  setTool(tool: Tool): void {
    if (this.built_for && isSameTool(tool, this.built_for)) return;
    this.built_for = tool;
    for (const child of [...this.group.children]) {
      this.group.remove(child);
      if (child instanceof Mesh || child instanceof LineSegments) (child.geometry as BufferGeometry).dispose();
    }
    const shape = shapeOf(tool);
    const solid = shape.geometry(tool);
    const jaw_m = (tool.opening_mm + tool.size_mm[2]) / 2000;
    for (const side of shape.jaws ? [-1, 1] : [0]) {
      const parts = [new Mesh(solid, this.fill), new LineSegments(shape.edges(solid, tool), this.lines)];
      parts.forEach((part, i) => {
        part.renderOrder = 17 + i;
        part.position.x = side * jaw_m;
        part.rotation.z = side < 0 ? Math.PI : 0;
        this.group.add(part);
      });
    }
  }

  /** Sets the robot's last report; null: no robot follows, or it is silent. */
  setRobot(robot: Robot | null, now_ms: number): void {
    const shown = robot?.heard === true;
    if (shown) {
      const [x, y, z, w, i, j, k] = robot.pose as [number, number, number, number, number, number, number];
      this.from.at.copy(this.group.position);
      this.from.turn.copy(this.group.quaternion);
      this.to.at.set(x, y, z);
      this.to.turn.set(i, j, k, w);
      if (!this.heard_of) {
        this.from.at.copy(this.to.at);
        this.from.turn.copy(this.to.turn);
      }
      this.since_ms = now_ms;
    }
    this.heard_of = shown;
    this.group.visible = shown;
  }

  /** Advances the motion; true while it continues. */
  advance(now_ms: number): boolean {
    if (!this.heard_of || this.since_ms === -Infinity) return false;
    const share = Math.min(1, Math.max(0, (now_ms - this.since_ms) / GLIDE_MS));
    this.group.position.lerpVectors(this.from.at, this.to.at, share);
    this.group.quaternion.slerpQuaternions(this.from.turn, this.to.turn, share);
    if (share === 1) this.since_ms = -Infinity;
    return true;
  }
}
