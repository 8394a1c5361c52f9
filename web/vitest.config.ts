import { defineConfig } from 'vitest/config';
import { protocolSource } from './resolve.config';

export default defineConfig({ ...protocolSource, test: { include: ['tests/unit/**/*.test.ts'], environment: 'node' } });
