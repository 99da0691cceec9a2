/* Rust's standard library wants this one function of Windows 10; wine 8 has no such library. Its numbers only seed
   hash tables, whose order nothing here depends on. */
int ProcessPrng(unsigned char *data, unsigned long long size)
{
    while (size-- > 0)
        *data++ = 4;
    return 1;
}
