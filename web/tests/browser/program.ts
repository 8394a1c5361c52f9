// The program under the page in a test: the executable named by HAPTOLITH, otherwise the mock.

import { spawn, type ChildProcess } from 'node:child_process';
import { MockServer } from '../mock-server';

export interface Program {
  readonly address: string;
  stop(): Promise<void>;
}

/** Starts it on a port, 0 for any free one. */
export async function startProgram(port = 0): Promise<Program> {
  const executable = process.env.HAPTOLITH;
  return executable ? startExecutable(executable, port) : startMock(port);
}

export function portOf(program: Program): number {
  return Number(new URL(program.address).port);
}

async function startMock(port: number): Promise<Program> {
  const server = new MockServer({ port });
  const listening = await server.listen();
  return { address: `http://127.0.0.1:${listening}/`, stop: () => server.close() };
}

async function startExecutable(executable: string, port: number): Promise<Program> {
  const child = spawn(executable, ['run', 'icra2021', '--port', String(port), '--serve'], {
    stdio: ['ignore', 'ignore', 'pipe'],
  });
  const address = await listeningAddress(child);
  return {
    address,
    stop: async () => {
      if (child.exitCode !== null) return;
      const ended = new Promise((resolve) => child.once('exit', resolve));
      child.kill('SIGINT');
      // A program that does not exit must not stay behind.
      const timer = setTimeout(() => child.kill('SIGKILL'), 10_000);
      await ended;
      clearTimeout(timer);
    },
  };
}

function listeningAddress(child: ChildProcess): Promise<string> {
  return new Promise((resolve, reject) => {
    let said = '';
    child.stderr!.setEncoding('utf8').on('data', (text: string) => {
      said += text;
      const found = /http:\/\/127\.0\.0\.1:\d+\//.exec(said);
      if (found) resolve(found[0]);
    });
    child.once('error', reject);
    child.once('exit', (code) => reject(new Error(`the program ended with ${code} before it listened:\n${said}`)));
  });
}
