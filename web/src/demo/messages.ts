// Messages between the page and the worker that runs the soil, in addition to those of the protocol. The latter are
// texts and byte arrays, as from a WebSocket.

export interface DemoScene {
  name: string;
  title: string;
}

export type ToWorker =
  | { do: 'open'; scene: string; changes: string }
  /** a message of the protocol */
  | { do: 'hear'; text: string }
  /** the page has accepted a message; otherwise the worker sends no more frames */
  | { do: 'took' }
  | { do: 'upload'; bytes: ArrayBuffer }
  | { do: 'changes' };

export type FromWorker =
  | { is: 'opened'; scenes: DemoScene[] }
  /** simulated time for which soil that has not been settled before has been settling */
  | { is: 'settling'; time_s: number }
  | { is: 'failed'; why: string }
  | { is: 'uploaded'; number: number }
  | { is: 'changes'; text: string };
