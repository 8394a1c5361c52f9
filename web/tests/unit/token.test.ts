import { describe, expect, it } from 'vitest';
import { takeToken } from '../../src/token';

/** A browser tab: its address and its storage. */
class Tab {
  readonly kept = new Map<string, string>();
  readonly history = { state: null, replaceState: (_state: unknown, _title: string, to?: string | URL | null) => this.go(String(to)) }; // prettier-ignore
  storage = () => ({
    getItem: (key: string) => this.kept.get(key) ?? null,
    setItem: (key: string, value: string) => void this.kept.set(key, value),
  });

  constructor(public href: string) {}

  go(to: string): void {
    this.href = to;
  }

  take = () => takeToken(this, this.history, this.storage);
}

describe('the token', () => {
  it('goes out of the address and stays with the tab', () => {
    const tab = new Tab('http://127.0.0.1:8080/?token=abc&study=participant');
    expect(tab.take()).toBe('abc');
    expect(tab.href).toBe('http://127.0.0.1:8080/?study=participant');
    expect(tab.take()).toBe('abc'); // the page is reloaded
    tab.go('http://127.0.0.1:8080/?token=def');
    expect(tab.take()).toBe('def');
    expect(tab.href).toBe('http://127.0.0.1:8080/');
  });

  it('is none where none is wanted', () => {
    const tab = new Tab('http://127.0.0.1:8080/?view=top');
    expect(tab.take()).toBeNull();
    expect(tab.href).toBe('http://127.0.0.1:8080/?view=top');
  });

  it('stays in the address where nothing may be kept', () => {
    const tab = new Tab('http://127.0.0.1:8080/?token=abc');
    tab.storage = () => {
      throw new Error('SecurityError');
    };
    expect(tab.take()).toBe('abc');
    expect(tab.href).toContain('token=abc');
    tab.go('http://127.0.0.1:8080/');
    expect(tab.take()).toBeNull();
  });
});
