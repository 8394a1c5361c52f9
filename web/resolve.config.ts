import { defaultClientConditions, defaultServerConditions } from 'vite';

const CONDITION = 'haptolith-source';

// The protocol's package as its sources, for the page and for programs in tests/: nothing has to be built before.
export const protocolSource = {
  resolve: { conditions: [CONDITION, ...defaultClientConditions] },
  ssr: { resolve: { conditions: [CONDITION, ...defaultServerConditions] } },
};
