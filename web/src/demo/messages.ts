// What the page and the worker that runs the soil tell each other, beside the messages of the protocol: these are texts and
// byte arrays, as a WebSocket would bring them.

export interface DemoScene {
  name: string;
  title: string;
}

export type ToWorker =
  | { do: 'open'; scene: string; changes: string }
  /** a message of the protocol */
  | { do: 'hear'; text: string }
  /** the page has taken a message: without, the worker sends no more pictures */
  | { do: 'took' }
  | { do: 'upload'; bytes: ArrayBuffer }
  | { do: 'changes' };

export type FromWorker =
  | { is: 'opened'; scenes: DemoScene[] }
  /** soil that nobody has settled before comes to rest, for so long */
  | { is: 'settling'; time_s: number }
  | { is: 'failed'; why: string }
  | { is: 'uploaded'; number: number }
  | { is: 'changes'; text: string };
