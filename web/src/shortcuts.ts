// All keyboard shortcuts in one table, for key events and for the help.

export interface Shortcut {
  /** as `KeyboardEvent.key`, lower case */
  keys: string[];
  /** text in the help; default: the keys themselves; empty: no separate line */
  shown?: string;
  label: string;
  group: 'touch' | 'tool' | 'view' | 'bed' | 'time' | 'page';
  run?: () => void;
}

export const TOUCH: Shortcut[] = [
  { keys: [], shown: 'finger on the tool', label: 'hold it and dig', group: 'touch' },
  { keys: [], shown: 'finger beside it', label: 'look around', group: 'touch' },
  { keys: [], shown: 'two fingers', label: 'look around; pinch for nearer and farther', group: 'touch' },
  { keys: [], shown: 'Tilt', label: 'nose down or up: 40° to 60° digs', group: 'touch' },
  { keys: [], shown: 'Controls', label: 'soil, body and tool; “drag anywhere to dig” for small tools', group: 'touch' },
  { keys: [], shown: 'tap a number', label: 'what it means', group: 'touch' },
];

/** Keys that move the tool; handled in hand/key_hand.ts. */
export const TOOL_KEYS: Shortcut[] = [
  { keys: [], shown: 'drag the tool', label: 'hold it and dig; Shift for fine', group: 'tool' },
  { keys: [], shown: 'wheel while held', label: 'away and nearer; from above: lower and raise', group: 'tool' },
  { keys: [], shown: '← → ↑ ↓', label: 'move it level', group: 'tool' },
  { keys: [], shown: 'Page Up / Down', label: 'raise and lower it', group: 'tool' },
  { keys: [], shown: 'Q E', label: 'turn it (yaw)', group: 'tool' },
  { keys: [], shown: 'W S', label: 'tilt it: nose down and up (pitch)', group: 'tool' },
  { keys: [], shown: 'A D', label: 'roll it', group: 'tool' },
  { keys: [], shown: 'gamepad', label: 'left stick level, right stick up and yaw, triggers pitch', group: 'tool' },
];

export const VIEW_KEYS: Shortcut[] = [
  {
    keys: [],
    shown: 'drag beside the tool',
    label: 'look around (also right or middle button, two fingers)',
    group: 'view',
  },
  { keys: [], shown: 'Shift + drag', label: 'look at another place', group: 'view' },
  { keys: [], shown: 'wheel, pinch', label: 'nearer and farther', group: 'view' },
];

/** Runs the shortcut of a key; false when it has none. */
export function runShortcut(shortcuts: Shortcut[], event: KeyboardEvent): boolean {
  if (event.altKey || event.metaKey) return false;
  const name = (event.ctrlKey ? 'ctrl+' : '') + event.key.toLowerCase();
  const shortcut = shortcuts.find((candidate) => candidate.keys.includes(name));
  if (!shortcut?.run) return false;
  shortcut.run();
  return true;
}

/** Whether a key is typed into a field, or handled by a focused control, and so is not a shortcut. */
export function isTyping(event: KeyboardEvent): boolean {
  const target = event.target;
  // A dialog that was just closed keeps the focus for a moment.
  if (!(target instanceof HTMLElement) || target.closest('dialog:not([open])')) return false;
  if (target instanceof HTMLInputElement) {
    if (target.type === 'number' || target.type === 'text') return event.key !== 'Escape';
    return ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', 'PageUp', 'PageDown', ' '].includes(event.key);
  }
  if (target instanceof HTMLSelectElement) return event.key !== 'Escape' && event.key !== '?';
  if (target instanceof HTMLButtonElement) return event.key === ' ' || event.key === 'Enter';
  return false;
}
