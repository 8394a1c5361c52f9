// The numbers over the picture: what the hand feels, and where the tool is.

import type { Frame, Scene } from '../protocol';
import { fixed, h, setText } from './html';

// Digits that change sixty times a second cannot be read.
const INTERVAL_MS = 100;

export class Readouts {
  readonly element: HTMLElement;
  private readonly force = h('span', { class: 'big numbers', 'data-test': 'force' }, '–');
  private readonly force_xyz = h('span', { class: 'numbers triple' }, '');
  private readonly torque = h('span', { class: 'big numbers', 'data-test': 'torque' }, '–');
  private readonly torque_xyz = h('span', { class: 'numbers triple' }, '');
  private readonly place = h('span', { class: 'big numbers', 'data-test': 'depth' }, '–');
  private readonly place_xyz = h('span', { class: 'numbers triple', 'data-test': 'position' }, '');
  private shown_ms = 0;

  constructor() {
    const row = (colour: string, name: string, unit: string, big: HTMLElement, triple: HTMLElement): HTMLElement =>
      h(
        'div',
        { class: 'readout' },
        h('span', { class: 'readout-name' }, h('i', { class: `swatch ${colour}`, 'aria-hidden': 'true' }), name),
        h('span', { class: 'readout-value' }, big, h('span', { class: 'unit' }, unit)),
        triple,
      );
    this.element = h(
      'div',
      { class: 'readouts', role: 'group', 'aria-label': 'What the hand feels' },
      row('swatch-force', 'force', 'N', this.force, this.force_xyz),
      row('swatch-torque', 'torque', 'mN m', this.torque, this.torque_xyz),
      row('swatch-tool', 'depth', 'mm', this.place, this.place_xyz),
    );
  }

  setFrame(frame: Frame, scene: Scene, now_ms: number): void {
    if (now_ms - this.shown_ms < INTERVAL_MS) return;
    this.shown_ms = now_ms;
    const triple = (values: readonly number[], digits: number, width: number): string =>
      values.map((value) => fixed(value, digits, width)).join(' ');
    setText(this.force, fixed(Math.hypot(...frame.force_n), 2, 5));
    setText(this.force_xyz, triple(frame.force_n, 2, 6));
    const torque_mnm = frame.torque_nm.map((value) => value * 1000);
    setText(this.torque, fixed(Math.hypot(...torque_mnm), 1, 5));
    setText(this.torque_xyz, triple(torque_mnm, 1, 6));
    const at_mm = frame.tool.position_m.map((value) => value * 1000);
    setText(this.place, fixed(scene.box.surface_m * 1000 - at_mm[2]!, 1, 5));
    setText(this.place_xyz, triple(at_mm, 1, 6));
  }
}
