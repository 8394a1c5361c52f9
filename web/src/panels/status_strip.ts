// The strip along the top: one word for the loop's timing, and its system. Numbers are one click away.

import type { Scene, Status } from 'haptolith-protocol';
import { EXPLAIN } from './explanations';
import { fixed, h, setText } from './html';
import { missesInWords, paceInBrief, paceInWords, PaceWatch, type Pace } from './pace';
import { sizesInWords } from './readouts';
import { explain } from './tooltip';

const UNKNOWN = '–';
const HOVER_DELAY_MS = 350;
const EDGE_PX = 8;

class Cell {
  readonly element: HTMLElement;
  private readonly value: HTMLElement;

  readonly explain: (text: string) => void;

  constructor(name: string, width_ch: number, explanation: string) {
    this.value = h('span', { class: 'cell-value numbers', style: `min-width:${width_ch}ch` }, UNKNOWN);
    this.element = h(
      'div',
      { class: 'cell', role: 'group', 'aria-label': name, tabindex: 0, 'data-cell': name },
      h('span', { class: 'cell-name', 'aria-hidden': 'true' }, name),
      this.value,
    );
    this.explain = explain(this.element, explanation);
  }

  set(text: string): void {
    setText(this.value, text);
  }
}

/** The word for the timing, and the details that open below it. */
class PaceButton {
  readonly details: HTMLElement;
  readonly button: HTMLButtonElement;
  private readonly words = h('p', {});
  private pinned = false;
  private timer = 0;

  constructor(cells: Cell[]) {
    this.details = h(
      'div',
      {
        class: 'pace-details',
        id: 'pace-details',
        role: 'group',
        'aria-label': 'State of the force loop',
        hidden: true,
      },
      this.words,
      ...cells.map((cell) => cell.element),
    );
    this.button = h(
      'button',
      {
        type: 'button',
        class: 'pace',
        'aria-expanded': 'false',
        'aria-controls': 'pace-details',
        onclick: () => this.toggle(),
      },
      UNKNOWN,
    );
    for (const part of [this.button, this.details]) {
      part.addEventListener('pointerenter', (event) => event.pointerType === 'mouse' && this.openSoon());
      part.addEventListener('pointerleave', (event) => event.pointerType === 'mouse' && this.leave());
    }
    addEventListener('keydown', (event) => event.key === 'Escape' && this.close());
    addEventListener('resize', () => this.close());
  }

  set(word: string, words: string, level: 'good' | 'warn' | 'none'): void {
    setText(this.button, word);
    setText(this.words, words);
    this.button.dataset.level = level;
  }

  private toggle(): void {
    clearTimeout(this.timer);
    if (this.pinned) return this.close();
    this.pinned = true;
    this.open();
  }

  private openSoon(): void {
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.open(), HOVER_DELAY_MS);
  }

  /** Closes the details, unless the pointer moves into them. */
  private leave(): void {
    clearTimeout(this.timer);
    if (!this.pinned) this.timer = window.setTimeout(() => this.close(), HOVER_DELAY_MS);
  }

  private open(): void {
    this.details.hidden = false;
    this.button.setAttribute('aria-expanded', 'true');
    const at = this.button.getBoundingClientRect();
    const { width } = this.details.getBoundingClientRect();
    this.details.style.left = `${Math.max(EDGE_PX, Math.min(at.left, innerWidth - width - EDGE_PX))}px`;
    this.details.style.top = `${at.bottom + EDGE_PX}px`;
  }

  private close(): void {
    this.pinned = false;
    this.details.hidden = true;
    this.button.setAttribute('aria-expanded', 'false');
  }
}

export class StatusStrip {
  readonly element: HTMLElement;
  private readonly time = new Cell('time', 8, EXPLAIN.time);
  private readonly body = new Cell('body', 6, EXPLAIN.body_shown);
  private readonly soil = new Cell('soil', 12, EXPLAIN.soil_shown);
  private readonly device = new Cell('device', 12, EXPLAIN.device);
  private readonly clients = new Cell('clients', 3, EXPLAIN.clients);
  private readonly success = new Cell('ticks in time, last 10 s', 8, EXPLAIN.in_time);
  private readonly missed = new Cell('missed, last 10 s', 8, EXPLAIN.missed);
  private readonly missed_all = new Cell('missed since the start', 8, EXPLAIN.missed_all);
  private readonly p99 = new Cell('tick p99', 8, EXPLAIN.tick_p99);
  private readonly rate = new Cell('rate', 8, EXPLAIN.rate);
  private readonly awake = new Cell('particles computed', 13, EXPLAIN.awake);
  private readonly real_time = new Cell('priority', 7, EXPLAIN.not_granted);
  private readonly pace = new PaceButton([
    this.success,
    this.missed,
    this.missed_all,
    this.p99,
    this.rate,
    this.awake,
    this.real_time,
  ]);
  private readonly offer: HTMLButtonElement;
  private readonly watch = new PaceWatch();
  private can_coarsen = false;
  private scene = -1;

  /** `for_pictures`: omits the machine's timing, because time is paused while a picture is drawn. */
  constructor(
    private readonly own_client: () => number | null,
    for_pictures: boolean,
    coarsen: () => void,
  ) {
    this.offer = h('button', { type: 'button', class: 'offer', hidden: true, onclick: coarsen }, 'Coarser soil');
    explain(this.offer, EXPLAIN.coarser);
    this.element = h(
      'div',
      { class: 'cells', role: 'group', 'aria-label': 'Status' },
      ...(for_pictures ? [] : [this.pace.button, this.offer]),
      ...[this.time, this.body, this.soil, this.device, ...(for_pictures ? [] : [this.clients])].map(
        (cell) => cell.element,
      ),
      ...(for_pictures ? [] : [this.pace.details]),
    );
  }

  /** Clears the numbers, which are unknown while the program does not respond. */
  setConnected(connected: boolean): void {
    if (connected) return;
    for (const cell of [this.success, this.missed, this.missed_all, this.p99, this.rate, this.awake, this.clients])
      cell.set(UNKNOWN);
    this.pace.set(UNKNOWN, 'No connection to the program.', 'none');
    this.offer.hidden = true;
    this.watch.clear();
  }

  /** Shows the simulated time of the displayed frame. */
  setTime(time_s: number): void {
    this.time.set(`${fixed(time_s, 1, 6)} s`);
  }

  setScene(scene: Scene): void {
    this.body.set(scene.body ?? `${Math.hypot(...scene.gravity_m_s2).toFixed(2)} m/s²`);
    this.awake.explain(`${EXPLAIN.awake} Radii: ${sizesInWords(scene)}.`);
    this.soil.set(scene.soil.preset ?? scene.soil.name ?? 'own');
    this.can_coarsen = scene.can_coarsen;
    if (scene.scene !== this.scene) this.watch.clear();
    this.scene = scene.scene;
  }

  setStatus(status: Status): void {
    this.showPace(this.watch.add(status, performance.now()));
    this.rate.set(
      status.paused ? 'paused' : `${fixed(status.rate_hz, 0, 4)} of ${fixed(1000 * status.speed, 0, 4)} Hz`,
    );
    this.missed_all.set(`${status.misses} of ${status.ticks}`);
    const p99_us = status.tick_us.p99;
    this.p99.set(`${fixed(p99_us, p99_us < 100 ? 1 : 0, 5)} µs`);
    this.awake.set(`${status.awake} of ${status.particles}`);
    this.device.set(status.device);
    const granted = status.real_time.scheduler !== null && status.real_time.scheduler !== 'SCHED_OTHER';
    this.real_time.set(granted ? 'real-time' : 'ordinary');
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

  private showPace(pace: Pace): void {
    const level = pace.kind === 'late' ? 'warn' : pace.kind === 'in time' ? 'good' : 'none';
    this.pace.set(paceInBrief(pace, this.can_coarsen), paceInWords(pace, this.can_coarsen), level);
    this.offer.hidden = pace.kind !== 'late' || !this.can_coarsen;
    this.success.set(pace.ticks > 0 ? `${fixed(100 * (1 - pace.misses / pace.ticks), 1, 5)} %` : UNKNOWN);
    this.missed.set(pace.ticks > 0 ? missesInWords(pace) : UNKNOWN);
  }
}
