// Tooltips of one sentence: on hover, on focus by keyboard, and on touch. Screen readers read the sentence as the
// element's description. Escape hides it.

import { h, setText } from './html';

const HOVER_DELAY_MS = 350;
const AWAY_PX = 6;
const EDGE_PX = 8;

/** The one visible sentence. */
class Bubble {
  private readonly element = h('div', { class: 'tooltip', role: 'tooltip', hidden: true });
  private readonly sources = h('div', { hidden: true });
  private source: HTMLElement | null = null;
  private timer = 0;
  private count = 0;

  constructor() {
    document.body.append(this.element, this.sources);
    this.element.addEventListener('pointerleave', () => this.hide());
    addEventListener('keydown', (event) => event.key === 'Escape' && this.hide());
    addEventListener('scroll', () => this.hide(), { capture: true });
    addEventListener('resize', () => this.hide());
  }

  /** Adds a text that screen readers find although it is hidden. */
  addSource(text: string): HTMLElement {
    const source = h('span', { id: `explained-${++this.count}` }, text);
    this.sources.append(source);
    return source;
  }

  showSoon(source: HTMLElement, around: HTMLElement): void {
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.show(source, around), HOVER_DELAY_MS);
  }

  /** Shows the sentence below its element, or above if there is no room; within the window. */
  show(source: HTMLElement, around: HTMLElement): void {
    clearTimeout(this.timer);
    if (!around.isConnected) return;
    // Placed in the same part of the page, so that users who navigate by landmarks find it there.
    const part = around.closest('header, main, aside') ?? document.body;
    if (this.element.parentElement !== part) part.append(this.element);
    this.source = source;
    this.element.hidden = false;
    this.refresh(source);
    const at = around.getBoundingClientRect();
    const { width, height } = this.element.getBoundingClientRect();
    const below = at.bottom + AWAY_PX + height < innerHeight - EDGE_PX;
    this.element.style.left = `${Math.max(EDGE_PX, Math.min(at.left, innerWidth - width - EDGE_PX))}px`;
    this.element.style.top = `${below ? at.bottom + AWAY_PX : Math.max(EDGE_PX, at.top - AWAY_PX - height)}px`;
  }

  refresh(source: HTMLElement): void {
    if (this.source === source) setText(this.element, source.textContent!);
  }

  hide(): void {
    clearTimeout(this.timer);
    this.element.hidden = true;
    this.source = null;
  }

  /** Hides the sentence, unless the pointer moves onto it. */
  leave(to: EventTarget | null): void {
    if (to !== this.element) this.hide();
  }
}

let bubble: Bubble | null = null;

/** Explains `element`, and shows the sentence when the pointer is on `around`, which may contain the element.
 * Returns a function that sets another text. */
export function explain(element: HTMLElement, text: string, around = element): (text: string) => void {
  const shown = (bubble ??= new Bubble());
  const source = shown.addSource(text);
  element.setAttribute('aria-describedby', source.id);
  around.addEventListener('pointerenter', (event) => event.pointerType === 'mouse' && shown.showSoon(source, around));
  around.addEventListener('pointerleave', (event) => event.pointerType === 'mouse' && shown.leave(event.relatedTarget));
  // A press operates a control; on other elements it shows the sentence.
  around.addEventListener('pointerdown', () => shown.hide());
  if (!/^(BUTTON|SELECT|INPUT)$/.test(element.tagName))
    element.addEventListener('click', () => shown.show(source, around));
  element.addEventListener('focusin', () => element.matches(':focus-visible') && shown.show(source, around));
  element.addEventListener('focusout', () => shown.hide());
  return (next) => {
    setText(source, next);
    shown.refresh(source);
  };
}
