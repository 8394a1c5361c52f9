// What a study adds to the protocol: docs/protocol.md, "Studies".

import { ProtocolError } from '../protocol_error';

export const ROLES = ['participant', 'experimenter'] as const;
export type Role = (typeof ROLES)[number];

export const PHASES = [
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
] as const;
export type Phase = (typeof PHASES)[number];

export type StudyCommand = { do: 'study' } & (
  | { act: 'join'; as: Role }
  // a participant's
  | { act: 'go' | 'quit' }
  | { act: 'fill'; values: Record<string, string> }
  | { act: 'answer'; choice: 0 | 1 }
  // an experimenter's
  | { act: 'pause' | 'resume' | 'end' }
  | { act: 'repeat'; which: 'now' | 'last'; reason: string }
  | { act: 'note'; text: string }
);

export const FIELD_KINDS = ['text', 'number', 'choice', 'scale', 'yes-no'] as const;

export interface Field {
  key: string;
  label: string;
  kind: (typeof FIELD_KINDS)[number];
  choices: string[];
  low: number;
  high: number;
  low_label: string;
  high_label: string;
  required: boolean;
}

export interface Progress {
  block: number;
  blocks: number;
  trial: number;
  /** null: nobody knows beforehand */
  trials: number | null;
}

export interface ParticipantMessage {
  type: 'study';
  as: 'participant';
  study: string;
  phase: Phase;
  title: string;
  /** paragraphs with blank lines between them */
  text: string;
  fields: Field[];
  /** what the button says that goes on; null: there is none */
  button: string | null;
  interval: number;
  intervals: number;
  label: string;
  /** null: nothing runs out */
  remaining_s: number | null;
  choices: string[];
  /** whether the scene may be seen */
  visual: boolean;
  can_dig: boolean;
  feedback: 'right' | 'wrong' | null;
  progress: Progress | null;
  problem: string | null;
}

export const TRIAL_KINDS = ['practice', 'main', 'catch'] as const;
export type TrialKind = (typeof TRIAL_KINDS)[number];

export interface TrialShown {
  kind: TrialKind;
  block: string;
  question: string;
  reference: string;
  test: string;
  value: number;
  test_first: boolean;
  /** the one that is felt now: 1 or 2; 0: none */
  interval: number;
}

export interface Answer {
  trial: number;
  block: string;
  kind: TrialKind;
  test: string;
  value: number;
  /** the test was said to have more; null: no answer was given */
  positive: boolean | null;
  correct: boolean | null;
  reaction_s: number | null;
  /** begun: it is under way */
  state: 'begun' | 'answered' | 'repeated' | 'lost';
  reason: string;
}

export interface Level {
  x: number;
  /** answers that the test had more, of n */
  k: number;
  n: number;
}

export interface BlockResult {
  name: string;
  axis_label: string;
  log_axis: boolean;
  reference: number;
  levels: Level[];
  /** x and the fitted share of "more" */
  curve: [number, number][] | null;
  threshold: number | null;
  weber_fraction: number | null;
}

export interface Note {
  at: string;
  kind: string;
  text: string;
}

export interface ExperimenterMessage {
  type: 'study';
  as: 'experimenter';
  study: string;
  file: string;
  participant: string;
  phase: Phase;
  paused: boolean;
  progress: Progress | null;
  now: TrialShown | null;
  next: TrialShown | null;
  force_n: number;
  peak_force_n: number;
  answers: Answer[];
  blocks: BlockResult[];
  notes: Note[];
  problem: string | null;
}

export type StudyMessage = ParticipantMessage | ExperimenterMessage;

/** Checks a message of a study and fills in what may be left out. @throws ProtocolError: says which key is wrong. */
export function readStudyMessage(value: object): StudyMessage {
  const keys = new Keys(value, 'study');
  const head = {
    type: 'study',
    study: keys.text('study'),
    phase: keys.oneOf('phase', PHASES),
    progress: keys.orNull('progress', readProgress),
    problem: keys.orNull('problem', asText),
  } as const;
  return keys.oneOf('as', ROLES) === 'participant'
    ? { ...head, ...participantKeys(keys) }
    : { ...head, ...experimenterKeys(keys) };
}

function participantKeys(keys: Keys) {
  return {
    as: 'participant' as const,
    title: keys.text('title', ''),
    text: keys.text('text', ''),
    fields: keys.list('fields', readField),
    button: keys.orNull('button', asText),
    interval: keys.number('interval', 0),
    intervals: keys.number('intervals', 0),
    label: keys.text('label', ''),
    remaining_s: keys.orNull('remaining_s', asNumber),
    choices: keys.list('choices', asText),
    visual: keys.flag('visual', false),
    can_dig: keys.flag('can_dig', false),
    feedback: keys.oneOf('feedback', ['right', 'wrong', null] as const, null),
  };
}

function experimenterKeys(keys: Keys) {
  return {
    as: 'experimenter' as const,
    file: keys.text('file', ''),
    participant: keys.text('participant', ''),
    paused: keys.flag('paused', false),
    now: keys.orNull('now', readTrial),
    next: keys.orNull('next', readTrial),
    force_n: keys.number('force_n', 0),
    peak_force_n: keys.number('peak_force_n', 0),
    answers: keys.list('answers', readAnswer),
    blocks: keys.list('blocks', readBlock),
    notes: keys.list('notes', readNote),
  };
}

function readProgress(value: unknown, where: string): Progress {
  const keys = new Keys(value, where);
  return {
    block: keys.number('block'),
    blocks: keys.number('blocks'),
    trial: keys.number('trial', 0),
    trials: keys.orNull('trials', asNumber),
  };
}

function readField(value: unknown, where: string): Field {
  const keys = new Keys(value, where);
  return {
    key: keys.text('key'),
    label: keys.text('label'),
    kind: keys.oneOf('kind', FIELD_KINDS),
    choices: keys.list('choices', asText),
    low: keys.number('low', 0),
    high: keys.number('high', 0),
    low_label: keys.text('low_label', ''),
    high_label: keys.text('high_label', ''),
    required: keys.flag('required', false),
  };
}

function readTrial(value: unknown, where: string): TrialShown {
  const keys = new Keys(value, where);
  return {
    kind: keys.oneOf('kind', TRIAL_KINDS),
    block: keys.text('block'),
    question: keys.text('question', ''),
    reference: keys.text('reference'),
    test: keys.text('test'),
    value: keys.number('value'),
    test_first: keys.flag('test_first'),
    interval: keys.number('interval', 0),
  };
}

function readAnswer(value: unknown, where: string): Answer {
  const keys = new Keys(value, where);
  return {
    trial: keys.number('trial'),
    block: keys.text('block'),
    kind: keys.oneOf('kind', TRIAL_KINDS),
    test: keys.text('test'),
    value: keys.number('value'),
    positive: keys.orNull('positive', asFlag),
    correct: keys.orNull('correct', asFlag),
    reaction_s: keys.orNull('reaction_s', asNumber),
    state: keys.oneOf('state', ['begun', 'answered', 'repeated', 'lost'] as const),
    reason: keys.text('reason', ''),
  };
}

function readBlock(value: unknown, where: string): BlockResult {
  const keys = new Keys(value, where);
  return {
    name: keys.text('name'),
    axis_label: keys.text('axis_label', ''),
    log_axis: keys.flag('log_axis', false),
    reference: keys.number('reference'),
    levels: keys.list('levels', readLevel),
    curve: keys.orNull('curve', (points, at) => asList(points, at, readPoint)),
    threshold: keys.orNull('threshold', asNumber),
    weber_fraction: keys.orNull('weber_fraction', asNumber),
  };
}

function readLevel(value: unknown, where: string): Level {
  const keys = new Keys(value, where);
  return { x: keys.number('x'), k: keys.number('k'), n: keys.number('n') };
}

function readNote(value: unknown, where: string): Note {
  const keys = new Keys(value, where);
  return { at: keys.text('at'), kind: keys.text('kind', 'note'), text: keys.text('text') };
}

function readPoint(value: unknown, where: string): [number, number] {
  const [x, p, ...more] = asList(value, where, asNumber);
  if (x === undefined || p === undefined || more.length > 0) throw wrong(where, 'two numbers');
  return [x, p];
}

type Reader<T> = (value: unknown, where: string) => T;

const wrong = (where: string, expected: string): ProtocolError => new ProtocolError(`${where} is not ${expected}`);

function asText(value: unknown, where: string): string {
  if (typeof value !== 'string') throw wrong(where, 'a text');
  return value;
}

function asNumber(value: unknown, where: string): number {
  if (typeof value !== 'number') throw wrong(where, 'a number');
  return value;
}

function asFlag(value: unknown, where: string): boolean {
  if (typeof value !== 'boolean') throw wrong(where, 'true or false');
  return value;
}

function asList<T>(value: unknown, where: string, read: Reader<T>): T[] {
  if (!Array.isArray(value)) throw wrong(where, 'a list');
  return value.map((item, i) => read(item, `${where}[${i}]`));
}

/** The keys of an object; with a fallback a key may be missing. */
class Keys {
  private readonly object: Record<string, unknown>;

  constructor(
    value: unknown,
    private readonly where: string,
  ) {
    if (typeof value !== 'object' || value === null || Array.isArray(value)) throw wrong(where, 'an object');
    this.object = value as Record<string, unknown>;
  }

  text = (key: string, fallback?: string): string => this.read(key, asText, fallback);
  number = (key: string, fallback?: number): number => this.read(key, asNumber, fallback);
  flag = (key: string, fallback?: boolean): boolean => this.read(key, asFlag, fallback);
  list = <T>(key: string, read: Reader<T>): T[] => this.read(key, (value, at) => asList(value, at, read), []);

  orNull<T>(key: string, read: Reader<T>): T | null {
    return this.read<T | null>(key, (value, at) => (value === null ? null : read(value, at)), null);
  }

  oneOf<T extends string | null>(key: string, names: readonly T[], fallback?: T): T {
    return this.read(
      key,
      (value, at) => {
        const name = names.find((candidate) => candidate === value);
        if (name === undefined) throw wrong(at, `one of ${names.join(', ')}`);
        return name;
      },
      fallback,
    );
  }

  private read<T>(key: string, read: Reader<T>, fallback?: T): T {
    const value = this.object[key];
    if ((value === undefined || value === null) && fallback !== undefined) return fallback;
    return read(value, `${this.where}.${key}`);
  }
}
