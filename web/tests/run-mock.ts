// npm run mock [PORT [WIDTH_M [LAYERS]]]: the stand-in for the program, for work on the page.

import { MockServer } from './mock-server';

const [port, width_m, layers] = process.argv.slice(2).map(Number);
const server = new MockServer({ port: port ?? 8080, width_m, layers });
console.error(`listening on http://127.0.0.1:${await server.listen()}/`);
