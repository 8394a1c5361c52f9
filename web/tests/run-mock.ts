// npm run mock [PORT [WIDTH_M [LAYERS]]]: the stand-in for the program, for work on the page; with a study, whose pages
// are /?study=participant and /?study=experimenter.

import { MockServer } from './mock-server';
import { MockStudy } from './mock-study';

const [port, width_m, layers] = process.argv.slice(2).map(Number);
const server = new MockServer({ port: port ?? 8080, width_m, layers, study: new MockStudy() });
console.error(`listening on http://127.0.0.1:${await server.listen()}/`);
