// The numbers over the picture: rendered force and torque, and position of the tool.

import { type Frame, grainsOf, type Robot, type Scene, type Vec3 } from 'haptolith-protocol';
import { shapeOf } from '../tool_shapes';
import { EXPLAIN } from './explanations';
import { fixed, h, setText } from './html';
import { explain } from './tooltip';

// Digits that change 60 times per second cannot be read.
const INTERVAL_MS = 100;

/** A number with its unit, and its three components. */
class Readout {
  readonly cells: HTMLElement[];
  private readonly name: HTMLElement;
  private readonly size: HTMLElement;
  private readonly components = ['x', 'y', 'z'].map(() => h('span', { class: 'numbers component' }));

  constructor(colour: string, name: string, unit: string, test: string, explanation: string) {
    this.name = h('span', {}, name);
    this.size = h('span', { class: 'big numbers', 'data-test': test });
    const label = h(
      'span',
      { class: 'readout-name', role: 'group', 'aria-label': name, tabindex: 0 },
      h('i', { class: `swatch ${colour}`, 'aria-hidden': 'true' }),
      this.name,
    );
    explain(label, explanation);
    this.cells = [
      label,
      h('span', { class: 'readout-value' }, this.size, h('span', { class: 'unit' }, unit)),
      ...this.components,
    ];
    this.clear();
  }

  show(size: number, components: Vec3, digits: number, name?: string): void {
    if (name !== undefined) setText(this.name, name);
    setText(this.size, fixed(size, digits, 5));
    this.components.forEach((cell, axis) => setText(cell, fixed(components[axis]!, digits, 6)));
  }

  clear(): void {
    for (const cell of [this.size, ...this.components]) setText(cell, '–');
  }
}

/** Returns the tool's height over or depth below the level surface: never a negative number. */
export function placeOf(tool_z_m: number, surface_m: number): { name: string; mm: number } {
  const above_mm = 1000 * (tool_z_m - surface_m);
  return above_mm >= 0 ? { name: 'above soil', mm: above_mm } : { name: 'depth', mm: -above_mm };
}

/** Formats the number of particles of each size, coarsest first: "80 of 7 mm, 120 of 3.5 mm". */
export function sizesInWords(scene: Scene): string {
  const counts = new Map<number, number>();
  for (const { count, radius_m } of grainsOf(scene)) {
    const radius_mm = Number((1000 * radius_m).toPrecision(3));
    counts.set(radius_mm, (counts.get(radius_mm) ?? 0) + count);
  }
  const coarsest_first = [...counts].sort(([a_mm], [b_mm]) => b_mm - a_mm);
  return coarsest_first.map(([radius_mm, count]) => `${count} of ${radius_mm} mm`).join(', ');
}

/** Describes the picture for screen readers. */
export function pictureInWords(scene: Scene, frame: Frame): string {
  const { name, mm } = placeOf(frame.tool.position_m[2], scene.box.surface_m);
  const tool = shapeOf(scene.tool).name;
  const place = name === 'depth' ? `${mm.toFixed(0)} mm deep in the soil` : `${mm.toFixed(0)} mm above the soil`;
  const [x_mm, y_mm] = frame.tool.position_m.map((value) => (1000 * value).toFixed(0));
  const stones = scene.stones ? ` and ${scene.stones.length} stone${scene.stones.length > 1 ? 's' : ''}` : '';
  const sizes = grainsOf(scene).length > 1 ? ` (${sizesInWords(scene)} radius)` : '';
  return (
    `A box of ${(1000 * scene.box.width_m).toFixed(0)} by ${(1000 * scene.box.length_m).toFixed(0)} mm with ` +
    `${scene.particles} particles${sizes}${stones}; ${tool} ${place}, at x ${x_mm} mm, y ${y_mm} mm; ` +
    `force ${Math.hypot(...frame.force_n).toFixed(2)} N.`
  );
}

/** Whether the robot is further behind than its link explains: it was disconnected, or its machine is too slow. */
function lags(robot: Robot): boolean {
  return robot.state === 'following' && robot.behind / 1000 > robot.round_trip_s + 1;
}

/** Formats the state of a robot: "robot following, 2.6 s behind". */
export function robotInWords(robot: Robot): string {
  if (!robot.heard) return robot.round_trip_s > 0 ? 'robot silent' : 'no reports from the robot yet';
  const why = robot.reason === null ? '' : ` (${robot.reason})`;
  const more = lags(robot) ? `, link delay ${robot.round_trip_s.toFixed(1)} s` : '';
  return `robot ${robot.state}${why}, ${(robot.behind / 1000).toFixed(1)} s behind${more}`;
}

/** Formats the estimated soil: "estimated soil: 34° (31 to 37), 150 Pa (90 to 240)". */
export function learnedInWords(learned: NonNullable<Robot['learned']>): string {
  const between = (interval: number[], unit: string) => {
    const [low, middle, high] = interval.map((number) => number.toFixed(0));
    return `${middle}${unit} (${low} to ${high})`;
  };
  return `estimated soil: ${between(learned.friction_angle_deg, '°')}, ${between(learned.cohesion_pa, ' Pa')}`;
}

export class Readouts {
  readonly element: HTMLElement;
  private readonly force = new Readout('swatch-force', 'force', 'N', 'force', EXPLAIN.force);
  private readonly torque = new Readout('swatch-torque', 'torque', 'mN m', 'torque', EXPLAIN.torque);
  private readonly place = new Readout('swatch-tool', 'above soil', 'mm', 'depth', EXPLAIN.depth);
  private readonly met = new Readout('swatch-robot', 'remote force', 'N', 'met', EXPLAIN.met);
  private readonly robot = h('span', { class: 'robot-state', tabindex: 0, role: 'group', 'aria-label': 'robot' });
  private readonly learned = h('span', {
    class: 'robot-state',
    tabindex: 0,
    role: 'group',
    'aria-label': 'estimated soil',
  });
  private shown_ms = 0;

  constructor() {
    const heads = ['x', 'y', 'z'].map((axis) => h('span', { class: 'component head' }, axis));
    const axes = h(
      'button',
      { type: 'button', class: 'axes', 'aria-pressed': 'false', onclick: () => this.showComponents(axes) },
      'x y z',
    );
    explain(axes, EXPLAIN.axes);
    this.element = h(
      'div',
      { class: 'readouts', role: 'group', 'aria-label': 'Force on the hand, and position of the tool' },
      axes,
      ...heads,
      ...this.force.cells,
      ...this.torque.cells,
      ...this.place.cells,
      ...this.met.cells,
      this.robot,
      this.learned,
    );
    explain(this.robot, EXPLAIN.robot);
    explain(this.learned, EXPLAIN.learned);
    this.setRobot(null);
  }

  /** Shows or hides the components. They need space over the picture, so they are hidden by default. */
  private showComponents(axes: HTMLButtonElement): void {
    axes.setAttribute('aria-pressed', String(this.element.classList.toggle('full')));
  }

  /** Shows the state of a remote robot, and the soil force on it; null: no robot. */
  setRobot(robot: Robot | null): void {
    for (const cell of [this.robot, ...this.met.cells]) cell.hidden = robot === null;
    const learned = robot?.learned ?? null;
    this.learned.hidden = learned === null;
    if (learned !== null) setText(this.learned, learnedInWords(learned));
    if (robot === null) return;
    setText(this.robot, robotInWords(robot));
    this.robot.dataset.level = !robot.heard ? 'bad' : robot.state === 'following' && !lags(robot) ? 'good' : 'warn';
    if (robot.heard) this.met.show(Math.hypot(...robot.met_n), robot.met_n, 2);
    else this.met.clear();
  }

  setFrame(frame: Frame, scene: Scene, now_ms: number): void {
    if (now_ms - this.shown_ms < INTERVAL_MS) return;
    this.shown_ms = now_ms;
    const torque_mnm = frame.torque_nm.map((value) => value * 1000) as Vec3;
    const at_mm = frame.tool.position_m.map((value) => value * 1000) as Vec3;
    const { name, mm } = placeOf(frame.tool.position_m[2], scene.box.surface_m);
    this.force.show(Math.hypot(...frame.force_n), frame.force_n, 2);
    this.torque.show(Math.hypot(...torque_mnm), torque_mnm, 1);
    this.place.show(mm, at_mm, 1, name);
  }

  /** Clears the numbers, which are unknown while the program does not respond. */
  clear(): void {
    for (const readout of [this.force, this.torque, this.place]) readout.clear();
  }
}
