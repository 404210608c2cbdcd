-- BLAKE2b (RFC 7693) in plain Lua, from version 5.2 on: a hash of up to 64 bytes of output, with an optional key.
--
--   local blake2b = dofile("blake2b.lua")
--   blake2b("abc", 64)             the hash of "abc", 64 bytes, as a string of bytes
--   blake2b(text, 16, key)         a tag of 16 bytes under a key of up to 64 bytes
--
-- A word of 64 bits is two numbers of 32 bits, low and high, so that a Lua without integers of 64 bits can compute it.

-- Operations on words of 32 bits: a library in Lua 5.2, operators from 5.3 on, which 5.2 could not even parse.
local bits = bit32 or load([[
  return {
    bxor = function(a, b) return a ~ b end,
    bor = function(a, b) return a | b end,
    lshift = function(a, n) return a << n & 0xffffffff end,
    rshift = function(a, n) return a >> n end,
  }]])()
local bxor, bor, lshift, rshift = bits.bxor, bits.bor, bits.lshift, bits.rshift

local WORD = 0x100000000  -- 2^32
local BLOCK = 128         -- bytes that are mixed in at a time
local ROUNDS = 12

-- The initial state: low and high halves (RFC 7693, section 2.6).
local IV_LOW = {0xf3bcc908, 0x84caa73b, 0xfe94f82b, 0x5f1d36f1, 0xade682d1, 0x2b3e6c1f, 0xfb41bd6b, 0x137e2179}
local IV_HIGH = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19}

-- Which word of the block each step of a round takes (section 2.7); rounds 11 and 12 are as 1 and 2.
local SIGMA = {
  {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
  {14, 10, 4, 8, 9, 15, 13, 6, 1, 12, 0, 2, 11, 7, 5, 3},
  {11, 8, 12, 0, 5, 2, 15, 13, 10, 14, 3, 6, 7, 1, 9, 4},
  {7, 9, 3, 1, 13, 12, 11, 14, 2, 6, 5, 10, 4, 0, 15, 8},
  {9, 0, 5, 7, 2, 4, 10, 15, 14, 1, 11, 12, 6, 8, 3, 13},
  {2, 12, 6, 10, 0, 11, 8, 3, 4, 13, 7, 5, 15, 14, 1, 9},
  {12, 5, 1, 15, 14, 13, 4, 10, 0, 7, 6, 3, 9, 2, 8, 11},
  {13, 11, 7, 14, 12, 1, 3, 9, 5, 0, 15, 4, 8, 6, 2, 10},
  {6, 15, 14, 9, 11, 3, 0, 8, 12, 2, 13, 7, 1, 4, 10, 5},
  {10, 2, 8, 4, 7, 6, 1, 5, 15, 11, 9, 14, 3, 12, 13, 0},
}

-- The four words that each of the eight steps of a round mixes: columns, then diagonals.
local STEPS = {
  {1, 5, 9, 13}, {2, 6, 10, 14}, {3, 7, 11, 15}, {4, 8, 12, 16},
  {1, 6, 11, 16}, {2, 7, 12, 13}, {3, 8, 9, 14}, {4, 5, 10, 15},
}

-- v[a] = v[a] + v[b] + (low, high), modulo 2^64.
local function add(low, high, a, b, more_low, more_high)
  local sum_low, sum_high = low[a] + low[b] + more_low, high[a] + high[b] + more_high
  while sum_low >= WORD do sum_low, sum_high = sum_low - WORD, sum_high + 1 end
  while sum_high >= WORD do sum_high = sum_high - WORD end
  low[a], high[a] = sum_low, sum_high
end

-- v[a] = (v[a] xor v[b]) turned right by n bits; by 32 the halves change places, and by 63 is left by 1.
local function xor_turn(low, high, a, b, n)
  local x, y = bxor(low[a], low[b]), bxor(high[a], high[b])
  if n == 32 then
    low[a], high[a] = y, x
  elseif n == 63 then
    low[a], high[a] = bor(lshift(x, 1), rshift(y, 31)), bor(lshift(y, 1), rshift(x, 31))
  else
    low[a], high[a] = bor(rshift(x, n), lshift(y, 32 - n)), bor(rshift(y, n), lshift(x, 32 - n))
  end
end

-- The function G of section 3.1: mixes two words of the block, x and y, into four words of the state.
local function mix(low, high, step, x_low, x_high, y_low, y_high)
  local a, b, c, d = step[1], step[2], step[3], step[4]
  add(low, high, a, b, x_low, x_high)
  xor_turn(low, high, d, a, 32)
  add(low, high, c, d, 0, 0)
  xor_turn(low, high, b, c, 24)
  add(low, high, a, b, y_low, y_high)
  xor_turn(low, high, d, a, 16)
  add(low, high, c, d, 0, 0)
  xor_turn(low, high, b, c, 63)
end

-- The sixteen words of a block, halves apart.
local function words_of(block)
  local low, high = {}, {}
  for i = 1, 16 do
    local a, b, c, d, e, f, g, h = block:byte(8 * i - 7, 8 * i)
    low[i] = a + b * 0x100 + c * 0x10000 + d * 0x1000000
    high[i] = e + f * 0x100 + g * 0x10000 + h * 0x1000000
  end
  return low, high
end

-- The function F of section 3.2: takes one block into the state. `total` counts the bytes so far, below 2^32.
local function compress(state, block, total, is_last)
  local m_low, m_high = words_of(block)
  local low, high = {}, {}
  for i = 1, 8 do
    low[i], high[i], low[i + 8], high[i + 8] = state.low[i], state.high[i], IV_LOW[i], IV_HIGH[i]
  end
  low[13] = bxor(low[13], total)
  if is_last then low[15], high[15] = bxor(low[15], 0xffffffff), bxor(high[15], 0xffffffff) end
  for round = 0, ROUNDS - 1 do
    local sigma = SIGMA[round % 10 + 1]
    for i = 1, 8 do
      local x, y = sigma[2 * i - 1] + 1, sigma[2 * i] + 1
      mix(low, high, STEPS[i], m_low[x], m_high[x], m_low[y], m_high[y])
    end
  end
  for i = 1, 8 do
    state.low[i] = bxor(bxor(state.low[i], low[i]), low[i + 8])
    state.high[i] = bxor(bxor(state.high[i], high[i]), high[i + 8])
  end
end

-- Four bytes of a half word, the lowest first.
local function bytes_of(half)
  local text = ""
  for _ = 1, 4 do
    text = text .. string.char(half % 0x100)
    half = rshift(half, 8)
  end
  return text
end

-- The hash of `text`: `size` bytes (1 to 64), under `key` (up to 64 bytes, or nil).
local function blake2b(text, size, key)
  key = key or ""
  local state = {low = {}, high = {}}
  for i = 1, 8 do state.low[i], state.high[i] = IV_LOW[i], IV_HIGH[i] end
  state.low[1] = bxor(state.low[1], 0x01010000 + #key * 0x100 + size)
  if #key > 0 then text = key .. ("\0"):rep(BLOCK - #key) .. text end
  local blocks = math.max(1, math.ceil(#text / BLOCK))
  for i = 1, blocks do
    local block = text:sub((i - 1) * BLOCK + 1, i * BLOCK)
    local total = math.min(i * BLOCK, #text)
    compress(state, block .. ("\0"):rep(BLOCK - #block), total, i == blocks)
  end
  local out = ""
  for i = 1, 8 do out = out .. bytes_of(state.low[i]) .. bytes_of(state.high[i]) end
  return out:sub(1, size)
end

return blake2b
