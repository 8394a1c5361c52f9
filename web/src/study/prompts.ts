// The participant's screen in each phase: one thing at a time, large enough to be read from two metres.

import type { ParticipantMessage } from 'haptolith-protocol';
import { h, setText } from '../panels/html';
import { clockText, type Countdown } from './countdown';
import { Form } from './form';
import { words } from './words/words';

export interface Acts {
  go(): void;
  fill(values: Record<string, string>): void;
  answer(choice: 0 | 1): void;
}

export class Prompts {
  readonly element = h('main', { class: 'prompt' });
  /** announces the screen to screen readers; it stays in the page while everything else changes */
  readonly announcer = h('p', { class: 'only-read-aloud', 'aria-live': 'polite' });
  private clock: HTMLElement | null = null;
  private bar: HTMLElement | null = null;
  private reason: HTMLElement | null = null;
  private work: HTMLElement | null = null;
  private held: string | null = null;
  private buttons: HTMLButtonElement[] = [];
  /** The last form with its input, which is restored after a pause. */
  private kept: { asked: string; form: Form; button: HTMLButtonElement } | null = null;

  constructor(
    private readonly acts: Acts,
    private readonly countdown: Countdown,
  ) {}

  show(message: ParticipantMessage): void {
    const { phase } = message;
    const title = fromProgram(message.title) || (words().titles[phase] ?? '');
    const text = fromProgram(message.text) || (words().texts[phase] ?? '');
    this.clock = null;
    this.bar = null;
    this.reason = null;
    this.work = null;
    this.held = null;
    this.buttons = [];
    const parts = this.partsOf(message, title, text);
    this.element.dataset.phase = phase;
    this.element.replaceChildren(...parts);
    this.element.scrollTop = 0;
    setText(
      this.announcer,
      [phase === 'interval' ? fromProgram(message.label) : title, text].filter(Boolean).join('. '),
    );
    this.tick();
  }

  /** Shows the visible progress of a robot's work. */
  setWork(work: string | null): void {
    if (this.work) setText(this.work, work ?? '');
  }

  /** Disables the buttons for a reason; null: enables them. */
  hold(why: string | null): void {
    if (why === this.held || this.element.dataset.phase !== 'interval') return;
    this.held = why;
    this.showHeld();
  }

  private showHeld(): void {
    for (const button of this.buttons) button.disabled = this.held !== null;
    if (this.reason) setText(this.reason, this.held ?? '');
    const [button] = this.buttons;
    if (this.held === null && button && document.activeElement === document.body) button.focus({ preventScroll: true });
  }

  /** Disables the buttons after an act, until the next screen. */
  lock(locked: boolean, choice: 0 | 1 | null = null): void {
    this.buttons.forEach((button, i) => {
      button.disabled = locked || this.held !== null;
      button.classList.toggle('chosen', locked && i === choice);
    });
  }

  /** Responds by key, as if the button were pressed. */
  choose(choice: 0 | 1): void {
    this.buttons[choice]?.click();
  }

  /** Shows the remaining time. */
  tick(): void {
    const left_s = this.countdown.remaining_s;
    if (this.clock) {
      this.clock.hidden = left_s === null;
      setText(this.clock, clockText(left_s ?? 0));
    }
    if (this.bar) {
      this.bar.hidden = left_s === null;
      this.bar.style.setProperty('--share', String(this.countdown.share));
    }
  }

  private partsOf(message: ParticipantMessage, title: string, text: string): HTMLElement[] {
    switch (message.phase) {
      case 'form':
        return this.form(message, title, text);
      case 'interval':
        return this.interval(message, text);
      case 'question':
        return [this.timeBar(), h('h1', {}, title), ...paragraphs(text), this.answers(message)];
      case 'feedback':
        return [
          mark(message.feedback),
          h('h1', {}, title || words().feedback[message.feedback ?? 'none']),
          ...paragraphs(text),
          ...this.goButton(message),
        ];
      case 'break':
        return [h('h1', {}, title), ...paragraphs(text), this.clockFace(), ...this.goButton(message)];
      case 'preparing':
      case 'waiting':
        return [
          h('h1', {}, title),
          ...paragraphs(text),
          h('div', { class: 'breathing', 'aria-hidden': 'true' }, h('i'), h('i'), h('i')),
          ...this.goButton(message),
        ];
      default:
        return [h('h1', {}, title), h('div', { class: 'words' }, ...paragraphs(text)), ...this.goButton(message)];
    }
  }

  private form(message: ParticipantMessage, title: string, text: string): HTMLElement[] {
    const asked = JSON.stringify([title, message.fields]);
    if (this.kept?.asked !== asked) {
      const form = new Form(message.fields, (values) => this.acts.fill(values));
      const button = h(
        'button',
        { type: 'submit', class: 'go' },
        fromProgram(message.button ?? '') || words().continue,
      );
      form.element.append(h('div', { class: 'go-row' }, button));
      this.kept = { asked, form, button };
    }
    const { form, button } = this.kept;
    button.disabled = false;
    this.buttons = [button];
    queueMicrotask(() => form.focus());
    return [h('h1', {}, title), ...paragraphs(text), form.element];
  }

  private interval(message: ParticipantMessage, text: string): HTMLElement[] {
    const dots = Array.from({ length: message.intervals }, (_, i) =>
      h('i', { class: i + 1 === message.interval ? 'now' : i + 1 < message.interval ? 'past' : null }),
    );
    this.clock = h('span', { class: 'clock numbers' });
    this.reason = h('p', { class: 'reason', role: 'status' });
    this.work = h('p', { class: 'work numbers' }, message.work ?? '');
    return [
      h(
        'div',
        { class: 'interval-label' },
        h('h1', {}, fromProgram(message.label)),
        h('div', { class: 'dots', 'aria-hidden': 'true' }, ...dots),
        this.timeBar(),
        this.clock,
      ),
      h('div', { class: 'interval-foot' }, ...paragraphs(text), this.work, this.reason, ...this.goButton(message)),
    ];
  }

  private answers(message: ParticipantMessage): HTMLElement {
    const keys = ['1', '2'];
    const arrows = ['←', '→'];
    this.buttons = message.choices
      .slice(0, 2)
      .map((choice, i) =>
        h(
          'button',
          { type: 'button', class: 'answer', onclick: () => this.acts.answer(i === 0 ? 0 : 1) },
          h('span', { class: 'answer-text' }, choice),
          h('span', { class: 'keys', 'aria-hidden': 'true' }, h('kbd', {}, keys[i]!), h('kbd', {}, arrows[i]!)),
        ),
      );
    return h('div', { class: 'answers' }, ...this.buttons);
  }

  private goButton(message: ParticipantMessage): HTMLElement[] {
    if (message.button === null) return [];
    const button = h(
      'button',
      { type: 'button', class: 'go', onclick: () => this.acts.go() },
      fromProgram(message.button),
    );
    this.buttons = [button];
    queueMicrotask(() => button.focus({ preventScroll: true }));
    return [h('div', { class: 'go-row' }, button)];
  }

  private clockFace(): HTMLElement {
    this.clock = h('div', { class: 'clock-face numbers', role: 'timer' });
    return this.clock;
  }

  private timeBar(): HTMLElement {
    this.bar = h('div', { class: 'time-bar', 'aria-hidden': 'true' });
    return this.bar;
  }
}

const fromProgram = (text: string): string => words().fromProgram(text);

/** Splits a text into its paragraphs at blank lines. */
export function splitParagraphs(text: string): string[] {
  return text
    .split(/\n\s*\n/)
    .map((paragraph) => paragraph.trim())
    .filter((paragraph) => paragraph !== '');
}

function paragraphs(text: string): HTMLElement[] {
  return splitParagraphs(text).map((paragraph) => h('p', {}, paragraph));
}

/** A tick or a cross in a ring: distinguished by shape and by colour. */
function mark(feedback: ParticipantMessage['feedback']): HTMLElement {
  const sign = { right: '✓', wrong: '✕', none: '·' }[feedback ?? 'none'];
  return h('div', { class: `mark ${feedback ?? 'none'}`, 'aria-hidden': 'true' }, sign);
}
