// Additions of a study to the protocol: docs/reference/web-protocol.md, "Studies". Keys of a message that may be absent
// or null get default values.

import * as v from 'valibot';

export const ROLES = ['participant', 'experimenter'] as const;
export type Role = (typeof ROLES)[number];

const Phase = v.picklist([
  'waiting',
  'consent',
  'form',
  'instructions',
  'preparing',
  'interval',
  'question',
  'feedback',
  'break',
  'paused',
  'finished',
  'withdrawn',
  'stopped',
]);
export type Phase = v.InferOutput<typeof Phase>;

export type StudyCommand = { do: 'study' } & (
  | { act: 'join'; as: Role }
  // acts of a participant
  | { act: 'go' | 'quit' }
  | { act: 'fill'; values: Record<string, string> }
  | { act: 'answer'; choice: 0 | 1 }
  // acts of an experimenter
  | { act: 'pause' | 'resume' | 'end' }
  | { act: 'repeat'; which: 'now' | 'last'; reason: string }
  | { act: 'note'; text: string }
);

const text = v.nullish(v.string(), '');
const number = v.nullish(v.number(), 0);
const flag = v.nullish(v.boolean(), false);
const textOrNull = v.nullish(v.string(), null);
const numberOrNull = v.nullish(v.number(), null);
const flagOrNull = v.nullish(v.boolean(), null);

const Field = v.object({
  key: v.string(),
  label: v.string(),
  kind: v.picklist(['text', 'number', 'choice', 'scale', 'yes-no']),
  choices: v.nullish(v.array(v.string()), () => []),
  low: number,
  high: number,
  low_label: text,
  high_label: text,
  required: flag,
});
export type Field = v.InferOutput<typeof Field>;

const Progress = v.object({
  block: v.number(),
  blocks: v.number(),
  trial: number,
  /** null: not known beforehand */
  trials: numberOrNull,
});
export type Progress = v.InferOutput<typeof Progress>;

const ParticipantMessage = v.object({
  type: v.literal('study'),
  as: v.literal('participant'),
  study: v.string(),
  phase: Phase,
  title: text,
  /** paragraphs with blank lines between them */
  text,
  fields: v.nullish(v.array(Field), () => []),
  /** label of the button that continues; null: no button */
  button: textOrNull,
  interval: number,
  intervals: number,
  label: text,
  /** visible progress of a robot's work: "23 of 40 mm"; null: not shown */
  work: textOrNull,
  /** null: no time limit */
  remaining_s: numberOrNull,
  choices: v.nullish(v.array(v.string()), () => []),
  /** whether the scene is visible */
  visual: flag,
  /** delay of the view relative to the rendered force */
  visual_delay_s: number,
  can_dig: flag,
  feedback: v.nullish(v.picklist(['right', 'wrong']), null),
  progress: v.nullish(Progress, null),
  /** the last message: the program ends */
  ended: flag,
  problem: textOrNull,
});
export type ParticipantMessage = v.InferOutput<typeof ParticipantMessage>;

const TrialKind = v.picklist(['practice', 'main', 'catch']);
export type TrialKind = v.InferOutput<typeof TrialKind>;

const TrialShown = v.object({
  kind: TrialKind,
  block: v.string(),
  question: text,
  reference: v.string(),
  test: v.string(),
  value: v.number(),
  test_first: v.boolean(),
  /** the current interval: 1 or 2; 0: none */
  interval: number,
});
export type TrialShown = v.InferOutput<typeof TrialShown>;

const Answer = v.object({
  trial: v.number(),
  block: v.string(),
  kind: TrialKind,
  test: v.string(),
  value: v.number(),
  /** whether the response was "test has more"; null: no response */
  positive: flagOrNull,
  correct: flagOrNull,
  /** result of work for a robot, which has no response; null: another kind of trial */
  work: v.nullish(v.object({ done: v.boolean(), time_s: numberOrNull, force_error: numberOrNull }), null),
  reaction_s: numberOrNull,
  /** begun: in progress */
  state: v.picklist(['begun', 'answered', 'repeated', 'lost']),
  reason: text,
});
export type Answer = v.InferOutput<typeof Answer>;

/** `k` of `n` responses were "test has more" */
const Level = v.object({ x: v.number(), k: v.number(), n: v.number() });
export type Level = v.InferOutput<typeof Level>;

const BlockResult = v.object({
  name: v.string(),
  axis_label: text,
  log_axis: flag,
  reference: v.number(),
  levels: v.nullish(v.array(Level), () => []),
  /** x and the fitted proportion of "more" */
  curve: v.nullish(v.array(v.tuple([v.number(), v.number()])), null),
  threshold: numberOrNull,
  weber_fraction: numberOrNull,
});
export type BlockResult = v.InferOutput<typeof BlockResult>;

const Note = v.object({ at: v.string(), kind: v.nullish(v.string(), 'note'), text: v.string() });
export type Note = v.InferOutput<typeof Note>;

const ExperimenterMessage = v.object({
  type: v.literal('study'),
  as: v.literal('experimenter'),
  study: v.string(),
  file: text,
  participant: text,
  /** the participant's group; null: the study has none, or it is not decided yet */
  group: textOrNull,
  phase: Phase,
  paused: flag,
  progress: v.nullish(Progress, null),
  now: v.nullish(TrialShown, null),
  next: v.nullish(TrialShown, null),
  force_n: number,
  peak_force_n: number,
  answers: v.nullish(v.array(Answer), () => []),
  blocks: v.nullish(v.array(BlockResult), () => []),
  notes: v.nullish(v.array(Note), () => []),
  /** in the last message: the participant's progress, and how to resume; null: the study continues */
  ended: textOrNull,
  problem: textOrNull,
});
export type ExperimenterMessage = v.InferOutput<typeof ExperimenterMessage>;

export const StudyMessage = v.variant('as', [ParticipantMessage, ExperimenterMessage]);
export type StudyMessage = v.InferOutput<typeof StudyMessage>;
