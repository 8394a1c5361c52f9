// What the participant's page works out from a message.

import type { ParticipantMessage } from 'haptolith-protocol';

/** What is shown before the program has said anything. */
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

/** The program's words, "no study is running", as a sentence. */
export function asSentence(words: string): string {
  if (words === '') return '';
  return words.charAt(0).toUpperCase() + words.slice(1) + (/[.!?]$/.test(words) ? '' : '.');
}

/** Equal for messages that show the same, however much time is left and work is done. */
export function whatIsShown(message: ParticipantMessage): string {
  return JSON.stringify({ ...message, work: null, remaining_s: null, problem: null });
}

/** Share of the whole study that is done, 0 to 1; a block whose length nobody knows counts when it is over. */
export function shareDone(progress: ParticipantMessage['progress']): number {
  if (!progress || progress.blocks === 0) return 0;
  const in_block = progress.trials && progress.trial > 0 ? (progress.trial - 1) / progress.trials : 0;
  return (progress.block - 1 + Math.min(1, in_block)) / progress.blocks;
}
