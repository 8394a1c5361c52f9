// The strip along the top: how the loop runs, and on what.

import type { Scene, Status } from 'haptolith-protocol';
import { EXPLAIN } from './explanations';
import { fixed, h, setText } from './html';
import { missesInWords } from './misses';
import { sizesInWords } from './readouts';
import { explain } from './tooltip';

const UNKNOWN = '–';
// Slow motion is paced by longer waits, and nobody feels it: only much too slow is news.
const SLOW = 0.97;
const SLOW_IN_SLOW_MOTION = 0.7;

type Level = 'good' | 'warn' | 'bad' | 'none';

class Cell {
  readonly element: HTMLElement;
  private readonly value: HTMLElement;

  readonly explain: (text: string) => void;

  constructor(name: string, width_ch: number, explanation: string) {
    this.value = h('span', { class: 'cell-value numbers', style: `min-width:${width_ch}ch` }, UNKNOWN);
    this.element = h(
      'div',
      { class: 'cell', role: 'group', 'aria-label': name, tabindex: 0 },
      h('span', { class: 'cell-name', 'aria-hidden': 'true' }, name),
      this.value,
    );
    this.explain = explain(this.element, explanation);
  }

  set(text: string, level: Level = 'none'): void {
    setText(this.value, text);
    this.element.dataset.level = level;
  }
}

export class StatusStrip {
  readonly element: HTMLElement;
  private readonly time = new Cell('time', 8, EXPLAIN.time);
  private readonly rate = new Cell('rate', 8, EXPLAIN.rate);
  private readonly success = new Cell('in time', 6, EXPLAIN.in_time);
  private readonly p99 = new Cell('tick p99', 8, EXPLAIN.tick_p99);
  private readonly awake = new Cell('awake', 13, EXPLAIN.awake);
  private readonly body = new Cell('body', 6, EXPLAIN.body_shown);
  private readonly soil = new Cell('soil', 12, EXPLAIN.soil_shown);
  private readonly device = new Cell('device', 12, EXPLAIN.device);
  private readonly real_time = new Cell('real time', 7, EXPLAIN.not_granted);
  private readonly clients = new Cell('clients', 3, EXPLAIN.clients);

  /** `for_pictures`: nothing about the machine's timing, because time stands still while a picture is drawn. */
  constructor(
    private readonly own_client: () => number | null,
    for_pictures: boolean,
  ) {
    const timing = [this.rate, this.success, this.p99];
    const cells = [
      this.time,
      ...(for_pictures ? [] : timing),
      this.awake,
      this.body,
      this.soil,
      this.device,
      ...(for_pictures ? [] : [this.real_time, this.clients]),
    ];
    this.element = h(
      'div',
      { class: 'cells', role: 'group', 'aria-label': 'Status' },
      ...cells.map((cell) => cell.element),
    );
  }

  /** Nothing is known of a program that does not answer. */
  setConnected(connected: boolean): void {
    if (connected) return;
    for (const cell of [this.rate, this.success, this.p99, this.awake, this.clients]) cell.set(UNKNOWN);
  }

  /** Simulated time, of the frame that is shown. */
  setTime(time_s: number): void {
    this.time.set(`${fixed(time_s, 1, 6)} s`);
  }

  setScene(scene: Scene): void {
    this.body.set(scene.body ?? `${Math.hypot(...scene.gravity_m_s2).toFixed(2)} m/s²`);
    this.awake.explain(`${EXPLAIN.awake} Radii: ${sizesInWords(scene)}.`);
    this.soil.set(scene.soil.preset ?? scene.soil.name ?? 'own');
  }

  setStatus(status: Status): void {
    const wanted_hz = 1000 * status.speed;
    const slow = status.rate_hz < (status.speed < 1 ? SLOW_IN_SLOW_MOTION : SLOW) * wanted_hz;
    if (status.paused) this.rate.set('paused', 'warn');
    else this.rate.set(`${fixed(status.rate_hz, 0, 4)} Hz`, slow ? 'warn' : 'good');
    const percent = 100 * status.success_rate;
    this.success.set(`${fixed(percent, 0, 3)} %`, percent >= 99 ? 'good' : percent >= 90 ? 'warn' : 'bad');
    this.success.explain(`${EXPLAIN.in_time} ${missesInWords(status)}`.trim());
    const p99_us = status.tick_us.p99;
    this.p99.set(
      `${fixed(p99_us, p99_us < 100 ? 1 : 0, 5)} µs`,
      p99_us < 500 ? 'good' : p99_us < 1000 ? 'warn' : 'bad',
    );
    const all = String(status.particles);
    this.awake.set(`${String(status.awake).padStart(all.length, '\u2007')} / ${all}`);
    this.device.set(status.device);
    const granted = status.real_time.scheduler !== null && status.real_time.scheduler !== 'SCHED_OTHER';
    this.real_time.set(granted ? 'granted' : 'no', granted ? 'good' : 'warn');
    this.real_time.explain(
      granted
        ? `${EXPLAIN.granted} (${status.real_time.scheduler}, memory ${status.real_time.memory_locked ? 'locked' : 'not locked'})`
        : EXPLAIN.not_granted,
    );
    const holder = status.held_by;
    const mine = holder !== null && holder === this.own_client();
    this.clients.set(
      holder === null ? String(status.clients) : `${status.clients}, ${mine ? 'you hold' : `${holder} holds`}`,
    );
  }
}
