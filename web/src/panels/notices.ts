// Notices of the program or the page: a banner for a lasting state, a toast for a refused action.

import { h, setText } from './html';

const TOAST_MS = 6000;
const READING_MS = 80; // per character
const MOST_TOASTS = 3;

export class Notices {
  readonly banner = h('div', { class: 'banner', role: 'status', 'aria-live': 'polite', hidden: true });
  readonly busy = h('div', { class: 'busy', role: 'status', 'aria-live': 'polite', hidden: true });
  readonly toasts = h('div', { class: 'toasts', role: 'alert' });
  private readonly banner_text = h('span', {});
  private readonly busy_text = h('span', { class: 'numbers' });

  constructor(retry: () => void) {
    this.banner.append(
      h('span', { class: 'spinner', 'aria-hidden': 'true' }),
      this.banner_text,
      h('button', { class: 'quiet', onclick: retry }, 'Try now'),
    );
    this.busy.append(h('span', { class: 'spinner', 'aria-hidden': 'true' }), this.busy_text);
  }

  setLink(connected: boolean, why: string | null): void {
    this.banner.hidden = connected;
    if (!connected) setText(this.banner_text, `${why ?? 'connection lost'}, retrying`);
  }

  setBusy(what: string | null): void {
    this.busy.hidden = what === null;
    if (what !== null) setText(this.busy_text, what);
  }

  toast(text: string): void {
    const toast = h('div', { class: 'toast' }, h('span', {}, text));
    const close = h('button', { class: 'icon-button', 'aria-label': 'Dismiss', onclick: () => toast.remove() }, '✕');
    toast.append(close);
    this.toasts.append(toast);
    while (this.toasts.children.length > MOST_TOASTS) this.toasts.firstElementChild!.remove();
    setTimeout(() => toast.remove(), Math.max(TOAST_MS, READING_MS * text.length));
  }
}
