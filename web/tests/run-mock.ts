// npm run mock [PORT [WIDTH_M [LAYERS]]]: the mock of the program, for work on the page. It includes a mesh among the
// tools, and a study, whose pages are /?study=participant and /?study=experimenter.

import { MockServer } from './mock-server';
import { MockStudy } from './mock-study';
import { SCOOP } from './scoop';

const [port, width_m, layers] = process.argv.slice(2).map(Number);
const server = new MockServer({ port: port ?? 8080, width_m, layers, mesh: SCOOP, study: new MockStudy() });
console.error(`listening on http://127.0.0.1:${await server.listen()}/`);
