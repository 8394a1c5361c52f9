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
  { keys: [], shown: 'finger on the tool', label: 'hold the tool and dig', group: 'touch' },
  { keys: [], shown: 'finger next to it', label: 'rotate the view', group: 'touch' },
  { keys: [], shown: 'two fingers', label: 'rotate the view; pinch to zoom', group: 'touch' },
  { keys: [], shown: 'Tilt', label: 'pitch of the tool; 40° to 60° to dig', group: 'touch' },
  { keys: [], shown: 'Controls', label: 'soil, body and tool; “drag anywhere to dig” for small tools', group: 'touch' },
  { keys: [], shown: 'tap a number', label: 'explanation', group: 'touch' },
];

/** Keys that move the tool; handled in hand/key_hand.ts. */
export const TOOL_KEYS: Shortcut[] = [
  { keys: [], shown: 'drag the tool', label: 'hold the tool and dig; Shift for fine motion', group: 'tool' },
  { keys: [], shown: 'wheel while held', label: 'move away or nearer; in the top view: lower or raise', group: 'tool' },
  { keys: [], shown: '← → ↑ ↓', label: 'move the tool horizontally', group: 'tool' },
  { keys: [], shown: 'Page Up / Down', label: 'raise or lower the tool', group: 'tool' },
  { keys: [], shown: 'Q E', label: 'yaw', group: 'tool' },
  { keys: [], shown: 'W S', label: 'pitch: nose down or up', group: 'tool' },
  { keys: [], shown: 'A D', label: 'roll', group: 'tool' },
  {
    keys: [],
    shown: 'gamepad',
    label: 'left stick: horizontal; right stick: up and yaw; triggers: pitch',
    group: 'tool',
  },
];

export const VIEW_KEYS: Shortcut[] = [
  {
    keys: [],
    shown: 'drag next to the tool',
    label: 'rotate the view (also right or middle button, two fingers)',
    group: 'view',
  },
  { keys: [], shown: 'Shift + drag', label: 'move the view', group: 'view' },
  { keys: [], shown: 'wheel, pinch', label: 'zoom', group: 'view' },
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
