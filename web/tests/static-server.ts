// Serves a folder as any file host does, without other functions.

import { createReadStream, existsSync, statSync } from 'node:fs';
import { createServer } from 'node:http';
import type { AddressInfo } from 'node:net';
import { extname, join, normalize, resolve } from 'node:path';

const TYPES: Record<string, string> = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript; charset=utf-8',
  '.css': 'text/css; charset=utf-8',
  '.svg': 'image/svg+xml',
  '.wasm': 'application/wasm',
};

export interface Served {
  readonly address: string;
  /** bytes sent of each requested file, by its path */
  readonly sent: Map<string, number>;
  close(): Promise<void>;
}

/** @param additional  additional files, by their paths; null: the file is missing */
export function serveFolder(folder: string, additional: Record<string, Buffer | null> = {}): Promise<Served> {
  const sent = new Map<string, number>();
  const server = createServer((request, response) => {
    const path = normalize(new URL(request.url ?? '/', 'http://here').pathname);
    const file = join(resolve(folder), path === '/' ? 'index.html' : path);
    const beside = additional[path];
    if (beside) {
      response.writeHead(200, { 'content-type': 'application/octet-stream' }).end(beside);
      return;
    }
    if (!existsSync(file) || !statSync(file).isFile()) {
      response.writeHead(404).end();
      return;
    }
    sent.set(path, statSync(file).size);
    response.writeHead(200, { 'content-type': TYPES[extname(file)] ?? 'application/octet-stream' });
    createReadStream(file).pipe(response);
  });
  return new Promise((ready) =>
    server.listen(0, '127.0.0.1', () =>
      ready({
        address: `http://127.0.0.1:${(server.address() as AddressInfo).port}/`,
        sent,
        close: () => new Promise((closed) => server.close(() => closed())),
      }),
    ),
  );
}
