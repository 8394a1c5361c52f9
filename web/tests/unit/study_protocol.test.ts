import {
  decodeMessage,
  encodeCommand,
  type ExperimenterMessage,
  type ParticipantMessage,
  ProtocolError,
} from 'haptolith-protocol';
import { describe, expect, it } from 'vitest';

const read = (message: object) => decodeMessage(JSON.stringify({ type: 'study', ...message }));

const PARTICIPANT = { as: 'participant', study: 'Friction', phase: 'question' };
const EXPERIMENTER = { as: 'experimenter', study: 'Friction', phase: 'interval' };

describe('messages of a study', () => {
  it('give a participant everything that a page needs, whatever is left out', () => {
    const message = read(PARTICIPANT) as ParticipantMessage;
    expect(message).toMatchObject({
      title: '',
      fields: [],
      button: null,
      remaining_s: null,
      choices: [],
      feedback: null,
    });
    expect(message).toMatchObject({ visual: false, can_dig: false, progress: null, problem: null });
  });

  it('carry forms, choices and progress to a participant', () => {
    const message = read({
      ...PARTICIPANT,
      phase: 'form',
      fields: [{ key: 'age', label: 'Age', kind: 'number', low: 18, high: 99, required: true }],
      choices: ['lighter', 'heavier'],
      progress: { block: 1, blocks: 2, trial: 3, trials: null },
      remaining_s: 12.5,
      feedback: 'wrong',
    }) as ParticipantMessage;
    expect(message.fields[0]).toEqual({
      key: 'age',
      label: 'Age',
      kind: 'number',
      choices: [],
      low: 18,
      high: 99,
      low_label: '',
      high_label: '',
      required: true,
    });
    expect(message.progress).toEqual({ block: 1, blocks: 2, trial: 3, trials: null });
    expect(message).toMatchObject({ choices: ['lighter', 'heavier'], remaining_s: 12.5, feedback: 'wrong' });
  });

  it('carry trials, answers, curves and notes to an experimenter', () => {
    const trial = { kind: 'catch', block: 'friction', reference: 'P3', test: 'P1', value: 1.21, test_first: true };
    const answer = { trial: 3, block: 'friction', kind: 'main', test: 'P1', value: 1.21, state: 'repeated' };
    const block = { name: 'friction', reference: 0.835, levels: [{ x: 0.6, k: 0, n: 3 }], curve: [[0.6, 0.1]] };
    const message = read({
      ...EXPERIMENTER,
      now: { ...trial, interval: 2 },
      answers: [{ ...answer, positive: true }, answer],
      blocks: [block],
      notes: [{ at: '2026-11-21T10:00:00Z', kind: 'pause', text: 'coffee' }],
    }) as ExperimenterMessage;
    expect(message.now).toMatchObject({ kind: 'catch', test_first: true, interval: 2 });
    expect(message.next).toBeNull();
    expect(message.answers.map(({ positive }) => positive)).toEqual([true, null]);
    expect(message.blocks[0]).toMatchObject({ curve: [[0.6, 0.1]], threshold: null, log_axis: false });
    expect(message.notes[0]!.text).toBe('coffee');
  });

  it.each([
    [{ ...PARTICIPANT, as: 'guest' }, 'study.as'],
    [{ ...PARTICIPANT, phase: 'sleeping' }, 'study.phase'],
    [{ ...PARTICIPANT, study: 1 }, 'study.study'],
    [{ ...PARTICIPANT, phase: undefined }, 'study.phase'],
    [{ ...PARTICIPANT, fields: [{ key: 'a', label: 'A', kind: 'colour' }] }, 'study.fields[0].kind'],
    [{ ...PARTICIPANT, choices: 'no list' }, 'study.choices'],
    [{ ...PARTICIPANT, remaining_s: 'soon' }, 'study.remaining_s'],
    [{ ...PARTICIPANT, progress: [] }, 'study.progress'],
    [{ ...PARTICIPANT, can_dig: 1 }, 'study.can_dig'],
    [{ ...EXPERIMENTER, now: { kind: 'main' } }, 'study.now.block'],
    [{ ...EXPERIMENTER, blocks: [{ name: 'a', reference: 1, curve: [[1]] }] }, 'study.blocks[0].curve[0]'],
    [{ ...EXPERIMENTER, answers: [{}] }, 'study.answers[0].trial'],
  ])('that are wrong say where: %#', (message, where) => {
    expect(() => read(message)).toThrow(ProtocolError);
    expect(() => read(message)).toThrow(where);
  });

  it('are asked for by commands with an act', () => {
    expect(JSON.parse(encodeCommand({ do: 'study', act: 'answer', choice: 1 }, 7))).toEqual({
      id: 7,
      do: 'study',
      act: 'answer',
      choice: 1,
    });
  });
});
