import { describe, expect, it } from 'vitest';
import { readSettings } from '../../src/settings';

describe('settings', () => {
  it('come from the address', () => {
    expect(readSettings('?view=top&colour=force&drawing=balls&theme=light&panels=0&quality=full', false)).toEqual({
      view: 'top',
      colour: 'force',
      drawing: 'balls',
      theme: 'light',
      panels: false,
      for_pictures: true,
      study: null,
      language: 'en',
    });
  });

  it('fall back to what the browser prefers, and forget nonsense', () => {
    expect(readSettings('?view=below&colour=mood', true)).toEqual({
      view: 'three-quarter',
      colour: 'plain',
      drawing: 'grains',
      theme: 'light',
      panels: true,
      for_pictures: false,
      study: null,
      language: 'en',
    });
    expect(readSettings('', false).theme).toBe('dark');
  });
});
