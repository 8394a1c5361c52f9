// Which page it is: the address says so.
//
//   bed_page.ts     the page that shows the bed and holds the tool
//   study/          the participant's and the experimenter's page of a study: `?study=participant`, `?study=experimenter`
//
// and what they are made of:
//
//   protocol.ts     what the program says and understands (docs/reference/web-protocol.md); study/protocol.ts: what a study adds
//   connection.ts   the line to the program; comes back by itself; token.ts: what the program wants to know first
//   view/           the picture: Stage holds all that stands in it; each thing has a file; shaders work in the scene's
//                   frame, in metres, so that a screen and a headset see the same
//   hand/           holding the tool: Hand sends where it is wished; mouse, keys, gamepad and controller move the wish
//   panels/         numbers, plots and controls around the picture
//   automation.ts   window.haptolith, for tests and for pictures from the command line
//
// Messages flow one way: program -> connection -> stage and panels. What a person does goes to the program as a command,
// and the page shows it when the program's next message says that it is so.

import './style.css';
import './study/study.css';
import { openBedPage } from './bed_page';
import { ServedProgram, SILENCE_FOR_PICTURES_MS, socketAddress } from './connection';
import { readSettings } from './settings';
import { openExperimenterPage } from './study/experimenter_page';
import { openParticipantPage } from './study/participant_page';
import { takeToken } from './token';

const settings = readSettings(location.search, matchMedia('(prefers-color-scheme: light)').matches);

const program = new ServedProgram(
  socketAddress(
    location,
    takeToken(location, history, () => sessionStorage),
  ),
  settings.for_pictures ? SILENCE_FOR_PICTURES_MS : undefined,
);

if (settings.study === 'participant') openParticipantPage(settings, program);
else if (settings.study === 'experimenter') openExperimenterPage(settings, program);
else openBedPage(settings, program);
