// Values that the participant's page derives from a message.

import type { ParticipantMessage } from 'haptolith-protocol';

/** Screen before the first message of the program. */
export function waiting(text: string): ParticipantMessage {
  return {
    type: 'study',
    as: 'participant',
    study: '',
    phase: 'waiting',
    title: '',
    text,
    fields: [],
    button: null,
    interval: 0,
    intervals: 0,
    label: '',
    work: null,
    remaining_s: null,
    choices: [],
    visual: false,
    visual_delay_s: 0,
    can_dig: false,
    feedback: null,
    progress: null,
    ended: false,
    problem: null,
  };
}

/** Formats the program's message, "no study is running", as a sentence. */
export function asSentence(words: string): string {
  if (words === '') return '';
  return words.charAt(0).toUpperCase() + words.slice(1) + (/[.!?]$/.test(words) ? '' : '.');
}

/** Returns an identical text for messages with the same screen, independent of the remaining time and the work done. */
export function whatIsShown(message: ParticipantMessage): string {
  return JSON.stringify({ ...message, work: null, remaining_s: null, problem: null });
}

/** Returns the completed fraction of the study, 0 to 1; a block of unknown length counts when it is finished. */
export function shareDone(progress: ParticipantMessage['progress']): number {
  if (!progress || progress.blocks === 0) return 0;
  const in_block = progress.trials && progress.trial > 0 ? (progress.trial - 1) / progress.trials : 0;
  return (progress.block - 1 + Math.min(1, in_block)) / progress.blocks;
}
